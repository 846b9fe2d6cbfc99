#include "server/interest/cull.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "protocol/model/displayed.hpp"
#include "server/interest/frustum.hpp"
#include "server/interest/patch_priority.hpp"
#include "tests/unit/interest/sample_world.hpp"

namespace trochoid {
namespace {

/// Whether a camera of the key sees the displaced surface over rest point p; curvature as a display transform.
bool seen(const ViewState& view, const CullKey& key, const SurfaceSample& s, LatticePoint p,
          double visibility, bool curved) {
    const double x = to_metres(p.x - view.position.x) - static_cast<double>(s.ax);
    const double z = to_metres(p.z - view.position.z) - static_cast<double>(s.az);
    const double along = std::sqrt(x * x + z * z);
    if (along > visibility) return false;
    ViewState lens = view;
    lens.tan_half_width = key.anchor.tan_half_width;
    const double y =
        static_cast<double>(s.ay) - to_metres(view.altitude) - (curved ? curvature_drop(along) : 0.0);
    return !outside(planes_of(lens, 0.1, visibility), {{x, y, z}, {0.0, 0.0, 0.0}});
}

/// The delivered patch whose rest points include p, if any.
bool delivered(const InterestState& state, LatticePoint p) {
    for (uint8_t level = finest_patch_level; level <= coarsest_patch_level; ++level)
        if (state.patches.contains(patch_at(p, level))) return true;
    return false;
}

LatticePoint around(Dice& dice, const CullKey& key) {
    const double r = std::exp(dice.between(1.0, 10.6));  // 3 m to 40 km
    const double a = dice.between(0.0, 6.2831853);
    return {key.anchor.position.x + to_lattice(r * std::cos(a)),
            key.anchor.position.z + to_lattice(r * std::sin(a))};
}

struct SurfaceTally {
    int seen = 0;
    int missing = 0;
};

SurfaceTally brute_force(const WorldState& world, const CullKey& key, const CullResult& result, int points,
                         Dice& dice) {
    SurfaceTally tally;
    const SeaInstant sea(world.sea, key.from + static_cast<int64_t>(dice.between(0.0, 119e6)));
    for (int i = 0; i < points; ++i) {
        const LatticePoint p = around(dice, key);
        const SurfaceSample s = sea.evaluate(p);
        const ViewState view = within_slack(key, dice);
        if (!seen(view, key, s, p, result.report.visibility, i % 2 == 0)) continue;
        ++tally.seen;
        tally.missing += delivered(result.state, p) ? 0 : 1;
    }
    return tally;
}

TEST(Cull, EveryVisiblePointOfTheDisplacedSurfaceLiesOnADeliveredPatch) {
    const WorldState world = eight_box_world();
    const InterestIndex index(world);
    Dice dice(11);
    SurfaceTally all;
    for (int i = 0; i < 40; ++i) {
        ViewState view = looking({dice.lattice(-9e3, 9e3), dice.lattice(-9e3, 9e3)}, dice.between(1.0, 90.0),
                                 dice.between(0.0, 6.28), dice.between(-0.9, 0.3));
        view.tan_half_width = static_cast<float>(dice.between(0.05, 1.5));
        CullKey key = key_around(view);
        key.patch_limit = 100'000;
        const CullResult result = cull(index, key);
        ASSERT_EQ(result.report.over_limit, 0U);
        const SurfaceTally tally = brute_force(world, key, result, 2500, dice);
        all.seen += tally.seen;
        all.missing += tally.missing;
    }
    EXPECT_EQ(all.missing, 0);
    EXPECT_GT(all.seen, 5000);
}

TEST(Cull, HighWavesBringPatchesInThatStillWaterWouldNot) {
    // The lower plane points half a degree above the horizon: only crests higher than the camera are in view.
    CullKey key = key_around(looking({0, 0}, 3.0, 0.0, 0.55));
    key.slack = 0;
    key.slack_tangent = 0.0F;
    SampleBox swell;
    swell.trains = 3;
    swell.shortest = 300.0;
    swell.longest = 500.0;
    swell.steepness = 0.4;
    const WorldState still = sample_world({}, 1);
    const WorldState high = sample_world({swell}, 1);
    const CullResult calm = cull(still, key);
    const CullResult rough = cull(high, key);
    EXPECT_EQ(calm.report.delivered, 0U);
    EXPECT_GT(rough.report.delivered, 0U);
    Dice dice(12);
    const SurfaceTally tally = brute_force(high, key, rough, 20'000, dice);
    EXPECT_EQ(tally.missing, 0);
    EXPECT_GT(tally.seen, 100);
}

TEST(Cull, SidewaysShiftsBringPatchesIn) {
    // A narrow view along the sea with 60 m of sideways motion and no padding.
    SampleBox choppy;
    choppy.trains = 3;
    choppy.shortest = 300.0;
    choppy.longest = 500.0;
    choppy.steepness = 0.75;
    choppy.choppiness = 4.0F;
    ViewState view = looking({0, 0}, 30.0, 0.3, -0.2);
    view.tan_half_width = 0.02F;
    view.viewport_width = 25;
    CullKey key = key_around(view);
    key.slack = 0;
    key.slack_tangent = 0.0F;
    const WorldState world = sample_world({choppy}, 17);
    const CullResult result = cull(world, key);
    ASSERT_EQ(result.report.over_limit, 0U);
    Dice dice(18);
    SurfaceTally all;
    for (int i = 0; i < 10; ++i) {
        const SurfaceTally tally = brute_force(world, key, result, 20'000, dice);
        all.seen += tally.seen;
        all.missing += tally.missing;
    }
    EXPECT_EQ(all.missing, 0);
    EXPECT_GT(all.seen, 500);
}

TEST(Cull, CurvatureBringsPatchesInFromBelowTheUpperPlane) {
    // Between depressions of 0.009 and 0.01 flat water lies 20 to 22 km away, curved water 25 to 30 km.
    ViewState view = looking({0, 0}, 200.0, 0.3, -0.0095);
    view.tan_half_height = 0.0005F;
    view.viewport_height = 1;
    CullKey key = key_around(view);
    key.slack = 0;
    key.slack_tangent = 0.0F;
    key.patch_limit = 100'000;
    const WorldState world = sample_world({}, 1);
    const CullResult result = cull(world, key);
    ASSERT_EQ(result.report.over_limit, 0U);
    Dice dice(19);
    const SurfaceTally tally = brute_force(world, key, result, 60'000, dice);
    EXPECT_EQ(tally.missing, 0);
    EXPECT_GT(tally.seen, 100);
}

TEST(Cull, NoPatchBehindTheCamera) {
    const WorldState world = eight_box_world();
    const InterestIndex index(world);
    Dice dice(13);
    for (int i = 0; i < 20; ++i) {
        const ViewState view =
            looking({dice.lattice(-9e3, 9e3), 0}, 20.0, dice.between(0.0, 6.28), dice.between(-0.3, 0.3));
        const CullResult result = cull(index, key_around(view));
        const Vec3 f = forward_of(view);
        double reach = 8.0;
        for (const auto& [id, box] : world.boxes) reach += displacement_bound(box->sea->record);
        for (const auto& [key, patch] : result.state.patches) {
            const LatticeRect r = rect_of(key);
            double ahead = -1e9;
            for (const LatticePoint c :
                 {r.min, r.max, LatticePoint{r.min.x, r.max.z}, LatticePoint{r.max.x, r.min.z}})
                ahead = std::max(
                    ahead, to_metres(c.x - view.position.x) * f.x + to_metres(c.z - view.position.z) * f.z);
            // Heights (20 m of altitude and the waves) tilt into `ahead` with the pitch.
            ASSERT_GE(ahead, -2.0 * reach - 40.0 * std::abs(f.y));
        }
    }
}

TEST(Cull, TypicalViewsTakeTwoToFiveHundredPatches) {
    const InterestIndex index(eight_box_world());
    for (const double altitude : {10.0, 30.0, 60.0})
        for (const double heading : {0.0, 1.0, 2.5, 4.0}) {
            const CullResult r = cull(index, key_around(looking({0, 0}, altitude, heading, -0.1)));
            EXPECT_GE(r.report.delivered, 200U) << altitude;
            EXPECT_LE(r.report.delivered, 512U) << altitude;
            EXPECT_EQ(r.report.over_limit, 0U);
        }
}

TEST(Cull, LimitKeepsThePatchesOfHighestPriorityAndCountsTheRest) {
    const InterestIndex index(eight_box_world());
    CullKey key = key_around(looking({0, 0}, 20.0, 0.5, -0.1));
    key.patch_limit = 1024;
    const CullResult all = cull(index, key);
    key.patch_limit = 100;
    const CullResult some = cull(index, key);
    EXPECT_EQ(some.report.delivered, 100U);
    EXPECT_EQ(some.report.over_limit, all.report.delivered - 100U);
    double least_kept = 1e9;
    for (const auto& [k, patch] : some.state.patches)
        least_kept = std::min(least_kept, priority(patch, key.anchor));
    for (const auto& [k, patch] : all.state.patches) {
        if (some.state.patches.contains(k)) continue;
        EXPECT_LE(priority(patch, key.anchor), least_kept);
    }
}

TEST(Cull, IsAPureFunctionOfWorldAndKey) {
    Dice dice(14);
    const WorldState world = eight_box_world();
    const InterestIndex first(world);
    const InterestIndex rebuilt(eight_box_world());
    const InterestIndex taken_over(world, &first);
    for (int i = 0; i < 10; ++i) {
        CullKey key = key_around(
            looking({dice.lattice(-4e3, 4e3), 0}, dice.between(2.0, 80.0), dice.between(0.0, 6.0), -0.1));
        key.regions.push_back({{0, 0}, 500 << 10});
        const uint64_t hash = hash_of(cull(first, key).state);
        EXPECT_EQ(hash, hash_of(cull(rebuilt, key).state));
        EXPECT_EQ(hash, hash_of(cull(taken_over, key).state));
        EXPECT_EQ(hash, hash_of(cull(world, key).state));
        key.anchor.position.x += to_lattice(300.0);
        EXPECT_NE(hash, hash_of(cull(first, key).state));
    }
}

TEST(InterestIndex, TakesOverOnlyTheSameObjects) {
    const CullKey key = key_around(looking({0, 0}, 20.0, 0.5, -0.1));
    const InterestIndex before(eight_box_world());
    // The same ids, other records: a replaced box must not be mistaken for the one that it replaces.
    SampleBox replaced;
    replaced.id = 3;
    replaced.land = true;
    const WorldState world = sample_world({replaced}, 20, island(500.0));
    const InterestIndex with_previous(world, &before);
    EXPECT_EQ(hash_of(cull(with_previous, key).state), hash_of(cull(world, key).state));
    EXPECT_EQ(with_previous.boxes().size(), 1U);
    const InterestIndex again(world, &with_previous);
    EXPECT_EQ(again.boxes(), with_previous.boxes());
    EXPECT_EQ(again.terrain(), with_previous.terrain());
}

TEST(Cull, PatchesUnderLandGoAndAreCounted) {
    SampleBox waves;
    waves.steepness = 0.3;
    waves.longest = 60.0;
    const auto land = island(2000.0);
    const WorldState world = sample_world({waves}, 2, land);
    CullKey view = key_around(looking({0, to_lattice(5000.0)}, 60.0, 0.0, -0.05));
    view.patch_limit = 100'000;
    const CullResult with = cull(world, view);
    const CullResult without = cull(sample_world({waves}, 2), view);
    EXPECT_GT(with.report.selection.under_land, 0U);
    EXPECT_LT(with.report.delivered, without.report.delivered);
    const double height = height_bound(world.boxes.at({1})->sea->record);
    int dry = 0;
    for (const auto& [key, patch] : without.state.patches) {
        if (with.state.patches.contains(key)) continue;
        ++dry;
        Dice dice(15);
        for (int i = 0; i < 50; ++i) {
            const LatticePoint p = dice.point_in(rect_of(key));
            ASSERT_GT(to_metres(height_at(*land, p.x, p.z)), height);
        }
    }
    EXPECT_GT(dry, 5);
    // A patch with its middle on the shore line stays.
    bool shore = false;
    for (const auto& [key, patch] : with.state.patches)
        shore = shore || contains(rect_of(key), {0, to_lattice(2160.0)});
    EXPECT_TRUE(shore);
}

TEST(Cull, ReportsWhatItLeftOut) {
    const InterestIndex index(eight_box_world());
    const CullResult r = cull(index, key_around(looking({0, 0}, 20.0, 0.5, -0.1)));
    EXPECT_GT(r.report.selection.considered, r.report.delivered);
    EXPECT_GT(r.report.selection.outside_frustum, 0U);
    EXPECT_GT(r.report.selection.beyond_horizon, 0U);
    EXPECT_GT(r.report.left_out.trains, 0U);
    EXPECT_EQ(r.report.boxes_alive, 8U);
    EXPECT_EQ(r.report.delivered, r.state.patches.size());
    EXPECT_GE(r.report.visibility, 12'000.0);
    // Every square ends in exactly one way; inner ones have four children.
    const SelectionCounts& c = r.report.selection;
    const uint32_t ended = c.outside_frustum + c.beyond_horizon + c.under_land + r.report.delivered;
    const uint32_t inner = c.considered - ended;
    EXPECT_GE(c.considered, 4 * inner);
    EXPECT_LE(c.considered - 4 * inner, 16U) << "roots";
}

TEST(Cull, StateHoldsWhatItsPatchesReferTo) {
    const WorldState world = eight_box_world();
    const CullResult r = cull(world, key_around(looking({0, 0}, 20.0, 0.5, -0.1)));
    for (const auto& [key, patch] : r.state.patches) {
        EXPECT_TRUE(std::is_sorted(patch.boxes.begin(), patch.boxes.end()));
        for (const PatchBox& b : patch.boxes) {
            ASSERT_TRUE(r.state.boxes.contains(b.box));
            EXPECT_LE(b.train_count, r.state.boxes.at(b.box)->trains.size());
        }
    }
    for (const auto& [key, block] : r.state.blocks) EXPECT_EQ(block.content, hash_of(*block.block));
    EXPECT_GT(r.state.blocks.size(), 0U);
}

TEST(Cull, BoxesThatAreOverOrNotYetBornTakeNoPart) {
    SampleBox over, unborn, coming;
    over.id = 1;
    over.end = {100'000'000};
    unborn.id = 2;
    unborn.begin = {2'000'000'000};
    coming.id = 3;
    coming.begin = {1'050'000'000};
    const CullResult r =
        cull(sample_world({over, unborn, coming}, 3), key_around(looking({0, 0}, 20.0, 0.5, -0.1)));
    EXPECT_EQ(r.report.boxes_alive, 1U);
    EXPECT_EQ(r.state.boxes.size(), 1U);
    EXPECT_TRUE(r.state.boxes.contains({3}));
}

TEST(Cull, WorksAtTheEdgeOfTheWorldAndFromHighUpAndBelow) {
    const InterestIndex index(sample_world({SampleBox{}}, 4));
    for (const LatticePoint corner :
         {LatticePoint{world_bound, world_bound}, LatticePoint{-world_bound, world_bound}})
        for (const double altitude : {-30.0, 0.0, 20.0, 9000.0, 2'000'000.0}) {
            const CullResult r = cull(index, key_around(looking(corner, altitude, 0.7, -0.6)));
            for (const auto& [key, patch] : r.state.patches) {
                EXPECT_TRUE(inside_world(rect_of(key).min));
                EXPECT_TRUE(inside_world(rect_of(key).max));
            }
        }
}

TEST(PatchPriority, NearInViewFirst) {
    const ViewState view = looking({0, 0}, 20.0, 0.0, 0.0);  // towards -z
    std::vector<PatchDescriptor> patches(3);
    patches[0].key = {16, 0, 3};    // behind
    patches[1].key = {16, 0, -40};  // ahead, far
    patches[2].key = {16, 0, -4};   // ahead, near
    sort_by_priority(patches, view);
    EXPECT_EQ(patches[0].key.z, -4);
    EXPECT_EQ(patches[1].key.z, 3);
    EXPECT_EQ(patches[2].key.z, -40);
    EXPECT_GT(priority(patches[0], view), priority(patches[1], view));
}

}  // namespace
}  // namespace trochoid
