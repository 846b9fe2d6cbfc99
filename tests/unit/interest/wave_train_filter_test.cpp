#include "server/interest/wave_train_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "protocol/model/displayed.hpp"
#include "protocol/model/point_query.hpp"
#include "protocol/model/sincos.hpp"
#include "tests/unit/interest/sample_world.hpp"

namespace trochoid {
namespace {

/// As a client or shader takes it: float32, from the camera's place.
float distance_to(const ViewState& camera, LatticePoint p) {
    const float dx = static_cast<float>(p.x - camera.position.x) * 0x1p-10F;
    const float dz = static_cast<float>(p.z - camera.position.z) * 0x1p-10F;
    const float dy = static_cast<float>(camera.altitude) * 0x1p-10F;
    return std::sqrt((dx * dx + dz * dz) + dy * dy);
}

size_t told(const PatchDescriptor& patch, BoxId box) {
    for (const PatchBox& b : patch.boxes)
        if (b.box == box) return b.train_count;
    return 0;
}

struct Scene {
    WorldState world = eight_box_world(40);
    CullKey key = key_around(looking({0, 0}, 20.0, 0.5, -0.1));
    CullResult result = cull(world, key);
    DisplayFilter filter = display_filter(key.anchor, key.error_in_force_px);
};

TEST(WaveTrainFilter, EveryTrainLeftOutIsWeightlessForEveryCameraInTheSlack) {
    const Scene s;
    Dice dice(21);
    uint32_t left_out = 0;
    for (const auto& [key, patch] : s.result.state.patches) {
        for (const auto& [id, box] : s.world.boxes) {
            for (size_t i = told(patch, id); i < box->sea->constants.size(); ++i) {
                ++left_out;
                for (int j = 0; j < 6; ++j) {
                    // Corners and edges too: the patch is closed.
                    LatticePoint p = dice.point_in(rect_of(key));
                    if (j % 2 == 0) p.x = j % 4 == 0 ? rect_of(key).min.x : rect_of(key).max.x;
                    const float spacing = vertex_spacing(s.filter, distance_to(within_slack(s.key, dice), p));
                    const Envelope e =
                        envelope_at(box->sea->record, instant_of(box->sea->record, s.key.until - 1), p);
                    if (e.gain == 0) continue;
                    ASSERT_EQ(displayed_weight(box->sea->constants[i].wavelength, spacing), 0.0F);
                }
            }
        }
    }
    EXPECT_GT(left_out, 1000U);
    EXPECT_GE(left_out, s.result.report.left_out.trains);
}

TEST(WaveTrainFilter, KeepsNoWholeGroupThatIsWeightlessEverywhere) {
    const Scene s;
    const PatchLod lod(s.key);
    int checked = 0;
    for (const auto& [key, patch] : s.result.state.patches) {
        const float nearest = static_cast<float>(lod.spacing(lod.distance(rect_of(key))));
        for (const PatchBox& b : patch.boxes) {
            const auto& constants = s.world.boxes.at(b.box)->sea->constants;
            const size_t group = filter_group(constants.size());
            if (b.train_count <= group) continue;
            ++checked;
            // The first train of the last group may show at the nearest vertex (0.2 % for the float32 margin).
            const size_t first = (b.train_count - 1U) / group * group;
            EXPECT_GT(displayed_weight(constants[first].wavelength, nearest * 0.998F), 0.0F);
        }
    }
    EXPECT_GT(checked, 100);
}

/// The displayed height from the first `count` trains of each box: weight 0 adds nothing, whatever its sign.
float displayed_height(const Scene& s, const PatchDescriptor* patch, SeaTime t, LatticePoint p,
                       float spacing) {
    float height = 0.0F;
    for (const auto& [id, box] : s.world.boxes) {
        const PreparedBox& sea = *box->sea;
        const Envelope e = envelope_at(sea.record, instant_of(sea.record, t), p);
        const size_t count = patch != nullptr ? told(*patch, id) : sea.constants.size();
        for (size_t i = 0; i < count; ++i) {
            const uint32_t phase = phase_from_place(sea.record.trains[i], p.x, p.z) +
                                   phase_at_origin(sea.record.trains[i], t.us);
            const float gain = static_cast<float>(e.gain) * 0x1p-24F *
                               displayed_weight(sea.constants[i].wavelength, spacing);
            height = sea.constants[i].a * (gain * sincos_turns(phase).cos) + height;
        }
    }
    return height;
}

TEST(WaveTrainFilter, DisplayedSurfaceIsTheSameWithoutTheTrainsLeftOut) {
    const Scene s;
    Dice dice(22);
    float largest = 0.0F;
    for (const auto& [key, patch] : s.result.state.patches)
        for (int j = 0; j < 4; ++j) {
            const LatticePoint p = dice.point_in(rect_of(key));
            const float spacing = vertex_spacing(s.filter, distance_to(within_slack(s.key, dice), p));
            const float full = displayed_height(s, nullptr, s.key.from, p, spacing);
            ASSERT_EQ(full, displayed_height(s, &patch, s.key.from, p, spacing));
            largest = std::max(largest, std::abs(full));
        }
    EXPECT_GT(largest, 0.3F);
}

/// The sea with only the trains that a patch was told of.
Sea prefix_sea(const Scene& s, const PatchDescriptor& patch) {
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (const PatchBox& b : patch.boxes) {
        const PreparedBox& whole = *s.world.boxes.at(b.box)->sea;
        WaveTrainBox record = whole.record;
        record.trains.resize(b.train_count);
        boxes.push_back(prepare(std::move(record), whole.fields));
    }
    return Sea(std::move(boxes));
}

TEST(WaveTrainFilter, StatedErrorsHoldAgainstTheSeaItself) {
    const Scene s;
    Dice dice(23);
    int patches = 0, points = 0;
    double closest_e = 0.0, closest_h = 0.0;
    for (const auto& [key, patch] : s.result.state.patches) {
        if (patch.left_out == 0.0F) continue;
        if (++patches % 2 == 0) continue;
        const SeaTime t = s.key.from + static_cast<int64_t>(dice.between(0.0, 119e6));
        const SeaInstant full(s.world.sea, t);
        const SeaInstant filtered(prefix_sea(s, patch), t);
        for (int j = 0; j < 12; ++j) {
            const LatticePoint p = dice.point_in(rect_of(key));
            const double e = std::abs(static_cast<double>(full.evaluate(p).ay) -
                                      static_cast<double>(filtered.evaluate(p).ay));
            ASSERT_LE(e, static_cast<double>(patch.left_out) + 1e-5);
            closest_e = std::max(closest_e, e / static_cast<double>(patch.left_out));
            const WaterPoint here = water_at(filtered, p);
            if (!contains(rect_of(key), here.rest)) continue;
            const double h =
                std::abs(static_cast<double>(water_at(full, p).height) - static_cast<double>(here.height));
            ASSERT_LE(h, static_cast<double>(patch.height_error) + 1e-3);
            closest_h = std::max(closest_h, h / static_cast<double>(patch.height_error));
            ++points;
        }
    }
    EXPECT_GT(points, 500);
    EXPECT_GT(closest_e, 0.3) << "a bound that is never approached is no bound worth stating";
    EXPECT_GT(closest_h, 0.1);
}

TEST(WaveTrainFilter, NothingLeftOutMeansNoError) {
    const Scene s;
    int exact = 0;
    for (const auto& [key, patch] : s.result.state.patches) {
        if (patch.left_out != 0.0F) continue;
        ++exact;
        EXPECT_EQ(patch.height_error, 0.0F);
    }
    EXPECT_GT(exact, 0);
}

TEST(WaveTrainFilter, MoreErrorInForceLeavesMoreOut) {
    Scene s;
    s.key.error_in_force_px = 4.0F;
    const CullResult coarse = cull(s.world, s.key);
    EXPECT_LT(coarse.report.delivered, s.result.report.delivered / 2);
    EXPECT_LT(coarse.report.trains_kept, s.result.report.trains_kept / 2);
}

TEST(Displayed, RampIsSmoothMonotoneAndExactAtItsEnds) {
    EXPECT_EQ(displayed_weight(2.0F, 1.0F), 0.0F);
    EXPECT_EQ(displayed_weight(1.0F, 1.0F), 0.0F);
    EXPECT_EQ(displayed_weight(4.0F, 1.0F), 1.0F);
    EXPECT_EQ(displayed_weight(40.0F, 1.0F), 1.0F);
    EXPECT_EQ(displayed_weight(3.0F, 1.0F), 0.5F);
    float before = 0.0F;
    for (int i = 0; i <= 1000; ++i) {
        const float w = displayed_weight(2.0F + 0.002F * static_cast<float>(i), 1.0F);
        EXPECT_GE(w, before);
        EXPECT_LE(w - before, 0.0031F);
        before = w;
    }
}

TEST(Displayed, DefaultViewShowsTwoMetresNearAndFadesTenBetweenOneAndTwoKilometres) {
    const DisplayFilter f = display_filter(ViewState{}, 1.0F);
    EXPECT_EQ(displayed_weight(2.0F, vertex_spacing(f, 10.0F)), 1.0F);
    EXPECT_EQ(displayed_weight(1.0F, vertex_spacing(f, 10.0F)), 0.0F);
    EXPECT_EQ(displayed_weight(10.0F, vertex_spacing(f, 790.0F)), 1.0F);
    EXPECT_GT(displayed_weight(10.0F, vertex_spacing(f, 1500.0F)), 0.0F);
    EXPECT_EQ(displayed_weight(10.0F, vertex_spacing(f, 1600.0F)), 0.0F);
}

TEST(Displayed, VisibilityFollowsTheHorizonWithinItsLimits) {
    EXPECT_EQ(visibility_distance(2.0, 0.0), 12'000.0);
    EXPECT_EQ(visibility_distance(-5.0, 0.0), 12'000.0);
    EXPECT_NEAR(visibility_distance(60.0, 0.0), 27'650.0, 10.0);
    EXPECT_EQ(visibility_distance(9000.0, 3.0), 60'000.0);
    EXPECT_NEAR(curvature_drop(10'000.0), 7.85, 0.01);
}

}  // namespace
}  // namespace trochoid
