// What moves, bends, rides on a ship or lies on changed land, culled and filtered, against the sea itself.
#include <gtest/gtest.h>

#include <cmath>

#include "protocol/model/displayed.hpp"
#include "protocol/model/point_query.hpp"
#include "server/interest/cull.hpp"
#include "server/interest/cull_key.hpp"
#include "server/world/world.hpp"
#include "tests/unit/interest/sample_world.hpp"

namespace trochoid {
namespace {

SeaTime within(SeaTime from, SeaTime until, Dice& dice) {
    return from + static_cast<int64_t>(dice.between(0.0, 1.0) * static_cast<double>(until - from));
}

/// Whether anything of the box may act at the point.
bool acts(const WaveTrainBox& box, SeaTime t, LatticePoint p) {
    const BoxInstant instant = instant_of(box, t);
    if (envelope_at(box, instant, p).gain == 0) return false;
    if (!box.trains.empty() || box.noise.amplitude != 0.0F) return true;
    const BoxPosition at = box_position(box, instant, p);
    const WakeSample w =
        wake_at(box.wake, box.length - at.u, at.v - box.width / 2, instant.wake_rear, instant.wake_front);
    return w.transverse.gain != 0 || w.diverging.gain != 0;
}

struct Touched {
    int acting = 0;
    int missed = 0;
    int apart = 0;
};

/// Random squares near a box against the points in them that the box acts on at random moments of the span.
Touched touch_points(const SampleBox& what, SeaTime from, SeaTime until, Dice& dice) {
    WorldState world;
    world.boxes[{1}] = sample_box(what, dice);
    const InterestIndex index(world);
    const WaveTrainBox& record = world.boxes[{1}]->sea->record;
    const LatticePoint anchor{what.origin.x + dice.lattice(-9e3, 9e3),
                              what.origin.z + dice.lattice(-9e3, 9e3)};
    const BoxFootprint f = footprint_over(*index.boxes()[0], anchor, from, until);
    const BoxFootprint whole = whole_footprint(*index.boxes()[0], anchor, from);
    Touched tally;
    for (int j = 0; j < 400; ++j) {
        const SeaTime t = within(from, until, dice);
        const LatticePoint corner = instant_of(record, t).origin;
        // Around the box where it is then.
        const double r = what.length + what.width;
        const LatticePoint p{corner.x + dice.lattice(-r, r), corner.z + dice.lattice(-r, r)};
        const PatchKey patch = patch_at(p, static_cast<uint8_t>(15 + j % 6));
        const SquareOnSea square = square_on_sea(rect_of(patch), anchor, 0.0);
        const bool touched = touches(f, square);
        tally.apart += touched ? 0 : 1;
        if (!acts(record, t, p)) continue;
        ++tally.acting;
        tally.missed += touched && touches(whole, square) ? 0 : 1;
    }
    return tally;
}

TEST(LiveBoxes, FootprintHoldsAllThatAMovingBoxSweeps) {
    Dice dice(41);
    Touched all;
    for (int i = 0; i < 300; ++i) {
        SampleBox what;
        what.origin = {dice.lattice(-4e6, 4e6), dice.lattice(-4e6, 4e6)};
        what.heading = dice.between(0.0, 6.3);
        what.length = dice.between(1100.0, 20'000.0);
        what.width = dice.between(1100.0, 20'000.0);
        what.trains = 2;
        what.speed = dice.between(-60.0, 60.0);
        if (i % 2 == 0) what.turn = dice.between(-3.0, 3.0);
        if (i % 5 == 0) what.front_speed = 17180 * 5;
        const SeaTime from{dice.lattice(-1e5, 2e6)};
        const Touched t = touch_points(what, from, from + (i % 3 == 0 ? 1'500'000'000 : 120'000'000), dice);
        all.acting += t.acting, all.missed += t.missed, all.apart += t.apart;
    }
    EXPECT_EQ(all.missed, 0);
    EXPECT_GT(all.acting, 4000);
    EXPECT_GT(all.apart, 20'000);
}

TEST(LiveBoxes, FootprintHoldsAShipsWakeAndLittleElse) {
    Dice dice(42);
    Touched all;
    for (int i = 0; i < 300; ++i) {
        SampleBox what;
        what.origin = {dice.lattice(-4e6, 4e6), dice.lattice(-4e6, 4e6)};
        what.heading = dice.between(0.0, 6.3);
        what.length = dice.between(2'000.0, 9'000.0);
        what.width = what.length * 0.76;
        what.trains = 0;
        what.speed = what.ship = dice.between(2.0, 15.0);
        if (i % 2 == 0) what.end = {dice.lattice(1e3, 9e5)};
        const SeaTime from{dice.lattice(0.0, 1e6)};
        const Touched t = touch_points(what, from, from + 20'000'000, dice);
        all.acting += t.acting, all.missed += t.missed, all.apart += t.apart;
    }
    EXPECT_EQ(all.missed, 0);
    EXPECT_GT(all.acting, 500);
    EXPECT_GT(all.apart, 40'000);
}

TEST(LiveBoxes, AYoungWakeTakesUpLittleOfItsBox) {
    Dice dice(43);
    SampleBox what;
    what.length = 9'000.0;
    what.width = 7'000.0;
    what.heading = 0.0;
    what.trains = 0;
    what.speed = what.ship = 10.0;
    WorldState world;
    world.boxes[{1}] = sample_box(what, dice);
    const InterestIndex index(world);
    // After 100 s half of 1 km has been left behind.
    const BoxFootprint f = footprint_over(*index.boxes()[0], {0, 0}, {90'000'000}, {100'000'000});
    const double ship = 9'000.0 + 1'000.0;
    EXPECT_TRUE(touches(f, {ship - 50.0, 3'500.0, 10.0}));
    EXPECT_FALSE(touches(f, {ship - 800.0, 3'500.0, 10.0}));
    EXPECT_FALSE(touches(f, {ship - 50.0, 4'500.0, 10.0}));
    EXPECT_FALSE(touches(f, {ship + 50.0, 3'500.0, 10.0}));
}

struct Scene {
    WorldState world = live_world();
    CullKey key = key_around(looking({to_lattice(1'500.0), to_lattice(1'400.0)}, 25.0, 0.5, -0.1));
    CullResult result = cull(world, key);
    DisplayFilter filter = display_filter(key.anchor, key.error_in_force_px);
};

/// Spacing as a client takes it, float32.
float spacing_at(const Scene& s, const ViewState& camera, LatticePoint p) {
    const float dx = static_cast<float>(p.x - camera.position.x) * 0x1p-10F;
    const float dz = static_cast<float>(p.z - camera.position.z) * 0x1p-10F;
    const float dy = static_cast<float>(camera.altitude) * 0x1p-10F;
    return vertex_spacing(s.filter, std::sqrt((dx * dx + dz * dz) + dy * dy));
}

/// Longest wave at which wake or noise of the box would still show there, m; 0 where neither acts.
float longest_extra(const WaveTrainBox& box, SeaTime t, LatticePoint p) {
    float longest = 0.0F;
    if (box.noise.amplitude != 0.0F) longest = 2.0F * static_cast<float>(1 << box.noise.step_log2) * 0x1p-10F;
    if (!has_wake(box.wake)) return longest;
    const float wake = 0x1p30F / static_cast<float>(box.wake.inverse_length);
    return acts(box, t, p) ? std::max(longest, wake) : longest;
}

TEST(LiveBoxes, APatchNamesEveryBoxThatMayShowOnIt) {
    const Scene s;
    Dice dice(44);
    int named = 0, wakes = 0, weightless = 0;
    for (const auto& [key, patch] : s.result.state.patches)
        for (int j = 0; j < 20; ++j) {
            const LatticePoint p = dice.point_in(rect_of(key));
            const SeaTime t = within(s.key.from, s.key.until, dice);
            const float spacing = spacing_at(s, within_slack(s.key, dice), p);
            for (const auto& [id, box] : s.world.boxes) {
                const WaveTrainBox& record = box->sea->record;
                if (!acts(record, t, p)) continue;
                const auto told =
                    std::find_if(patch.boxes.begin(), patch.boxes.end(),
                                 [wanted = record.id](const PatchBox& b) { return b.box == wanted; });
                const size_t count = told == patch.boxes.end() ? 0 : told->train_count;
                for (size_t i = count; i < record.trains.size(); ++i)
                    ASSERT_EQ(displayed_weight(box->sea->constants[i].wavelength, spacing), 0.0F);
                if (told != patch.boxes.end()) {
                    ++named;
                    wakes += has_wake(record.wake) ? 1 : 0;
                    continue;
                }
                const float extra = longest_extra(record, t, p);
                if (extra == 0.0F) continue;
                ++weightless;
                ASSERT_EQ(displayed_weight(extra, spacing), 0.0F);
            }
        }
    EXPECT_GT(named, 5000);
    EXPECT_GT(wakes, 100);
    EXPECT_GT(weightless, 100);
    EXPECT_GT(s.result.report.left_out.noises, 0U);
}

/// The sea with only what a patch was told of.
Sea prefix_sea(const Scene& s, const PatchDescriptor& patch) {
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (const PatchBox& b : patch.boxes) {
        const PreparedBox& whole = *s.world.boxes.at(b.box)->sea;
        WaveTrainBox record = whole.record;
        record.trains.resize(b.train_count);
        std::vector<std::shared_ptr<const LandField>> fields = whole.fields;
        for (size_t i = 0; i < fields.size(); ++i)
            if (fields[i]->base()) fields.push_back(fields[i]->base());
        boxes.push_back(prepare(std::move(record), fields));
    }
    return Sea(std::move(boxes));
}

TEST(LiveBoxes, StatedErrorsHoldAgainstTheSeaItself) {
    const Scene s;
    Dice dice(45);
    int points = 0;
    double closest_e = 0.0, closest_h = 0.0;
    for (const auto& [key, patch] : s.result.state.patches) {
        const SeaTime t = within(s.key.from, s.key.until, dice);
        const SeaInstant full(s.world.sea, t);
        const SeaInstant filtered(prefix_sea(s, patch), t);
        for (int j = 0; j < 8; ++j) {
            const LatticePoint p = dice.point_in(rect_of(key));
            const double e = std::abs(static_cast<double>(full.evaluate(p).ay) -
                                      static_cast<double>(filtered.evaluate(p).ay));
            ASSERT_LE(e, static_cast<double>(patch.left_out) + 1e-5);
            if (patch.left_out > 0.0F)
                closest_e = std::max(closest_e, e / static_cast<double>(patch.left_out));
            const WaterPoint here = water_at(filtered, p);
            if (!contains(rect_of(key), here.rest)) continue;
            const double h =
                std::abs(static_cast<double>(water_at(full, p).height) - static_cast<double>(here.height));
            ASSERT_LE(h, static_cast<double>(patch.height_error) + 1e-3);
            if (patch.height_error > 0.01F)
                closest_h = std::max(closest_h, h / static_cast<double>(patch.height_error));
            ++points;
        }
    }
    EXPECT_GT(points, 1000);
    EXPECT_GT(closest_e, 0.2);
    EXPECT_GT(closest_h, 0.05);
}

TEST(LiveBoxes, EveryPointThatTheSeaMovesLiesOnAPatchThatNamesTheBoxes) {
    const Scene s;
    Dice dice(46);
    int moved = 0;
    for (const auto& [key, patch] : s.result.state.patches) {
        const SeaTime t = within(s.key.from, s.key.until, dice);
        const SeaInstant full(s.world.sea, t);
        for (int j = 0; j < 6; ++j) {
            const LatticePoint p = dice.point_in(rect_of(key));
            const float here = full.evaluate(p).ay;
            if (here == 0.0F) continue;
            ++moved;
            // What no box of the patch explains stays below what the patch says is missing.
            ASSERT_TRUE(!patch.boxes.empty() || std::abs(here) <= patch.left_out + 1e-5F);
        }
    }
    EXPECT_GT(moved, 500);
}

TEST(LiveBoxes, SyncRegionsGiveTheWorldsBits) {
    const WorldState world = live_world();
    Dice dice(47);
    size_t boxes = 0;
    for (int i = 0; i < 20; ++i) {
        CullKey key = key_around(looking({to_lattice(90e3), 0}, 20.0, 1.57, 0.0));
        for (int j = 0; j < 2; ++j)
            key.regions.push_back({{dice.lattice(-7000.0, 5000.0), dice.lattice(-5000.0, 4000.0)},
                                   static_cast<uint32_t>(dice.lattice(5.0, 1500.0))});
        const InterestState state = cull(world, key).state;
        boxes += state.boxes.size();
        const Sea sea = sea_of(state);
        for (int k = 0; k < 4; ++k) {
            const SeaTime t = key.from + static_cast<int64_t>(dice.between(-590e6, 3000e6));
            const SeaInstant theirs(sea, t);
            const SeaInstant ours(world.sea, t);
            for (const SyncRegion& region : key.regions)
                for (int n = 0; n < 40; ++n) {
                    const double r = to_metres(region.radius) * 0.7;
                    const LatticePoint p{region.centre.x + dice.lattice(-r, r),
                                         region.centre.z + dice.lattice(-r, r)};
                    ASSERT_EQ(theirs.evaluate(p), ours.evaluate(p));
                    ASSERT_EQ(water_at(theirs, p), water_at(ours, p));
                }
        }
    }
    EXPECT_GT(boxes, 40U);
}

TEST(LiveBoxes, ChangedBlocksTravelUnderTheOverlayTheOthersUnderTheBase) {
    const WorldState world = live_world();
    CullKey key = key_around(looking({to_lattice(90e3), 0}, 20.0, 1.57, 0.0));
    key.regions.push_back({{0, 0}, static_cast<uint32_t>(to_lattice(1'500.0))});
    const InterestState state = cull(world, key).state;
    // Box 2: bases 21 and 22, overlays 25 and 26 over them.
    EXPECT_FALSE(state.blocks.contains({{21}, {-1, -1}}));
    EXPECT_TRUE(state.blocks.contains({{25}, {-1, -1}}));
    EXPECT_TRUE(state.blocks.contains({{22}, {0, 0}}));
    EXPECT_FALSE(state.blocks.contains({{26}, {0, 0}}));
    ASSERT_TRUE(state.blocks.contains({{25}, {1, 1}}));
    EXPECT_TRUE(trivial(*state.blocks.at({{25}, {1, 1}}).block)) << "calm again, and told so";
    EXPECT_FALSE(state.blocks.contains({{21}, {1, 1}}));
}

TEST(LiveBoxes, ChangedTerrainIsCulledByAnew) {
    WorldState world = sample_world({}, 2, island(500.0));
    const InterestIndex before(world);
    CullKey key = key_around(looking({0, to_lattice(5000.0)}, 60.0, 0.0, -0.05));
    key.patch_limit = 100'000;
    world.terrain = island(2'500.0);
    const InterestIndex after(world, &before);
    EXPECT_NE(after.terrain(), before.terrain());
    EXPECT_GT(cull(after, key).report.selection.under_land, cull(before, key).report.selection.under_land);
    EXPECT_EQ(hash_of(cull(after, key).state), hash_of(cull(world, key).state));
}

TEST(LiveBoxes, IrregularRoundAndOrbitsRaiseTheStatedBounds) {
    SampleBox plain;
    plain.length = plain.width = 20'000.0;
    plain.origin = {to_lattice(-10'000.0), to_lattice(-10'000.0)};
    plain.land = true;
    const auto largest = [](const SampleBox& box) {
        const CullResult r = cull(sample_world({box}, 6), key_around(looking({0, 0}, 20.0, 0.5, -0.1)));
        float lift = 0.0F;
        for (const auto& [key, patch] : r.state.patches) lift = std::max(lift, patch.left_out);
        return std::pair(lift, r.report.largest_error);
    };
    const auto [lift, error] = largest(plain);
    SampleBox irregular = plain;
    irregular.share = 1.0;
    EXPECT_NEAR(largest(irregular).first, 2.0F * lift, 0.01F * lift);
    SampleBox round = plain;
    round.roundness = 1.0;
    EXPECT_EQ(largest(round).first, lift);
    EXPECT_GT(largest(round).second, error);
}

/// A world with one ship, which may have stopped, and a camera 300 m off at 40 m above the water.
struct ShipInSight {
    explicit ShipInSight(float speed, bool stopped) {
        StartShip asked;
        asked.at = {to_lattice(100), to_lattice(-300)};
        asked.towards_degrees = 90.0F;
        asked.speed = speed;
        asked.length = 120.0F;
        World world("test", nullptr, {});
        const auto start = [&](const auto& what) {
            world.apply({world.state()->log_position.value + 1, {0}, what}, std::vector<uint8_t>{1});
        };
        start(world.plan(asked, {0}).value());
        if (stopped) {
            const Steering steering = world.plan(Steer{{1}, 0.0F, 0.0F}, {1000}).value();
            for (const auto& what : steering.events) start(what);
        }
        state = world.state();
        view.altitude = 40 * lattice_per_metre;
    }
    CullResult seen(SeaTime now) const {
        const InterestIndex index(*state);
        return cull(index, choose_key(index, view, {}, nullptr, now));
    }
    std::shared_ptr<const WorldState> state;
    ViewState view;
};

TEST(LiveBoxes, AShipThatLiesStillIsToldWhereSheIsSeen) {
    ShipInSight sight(8.0F, true);
    const CullResult seen = sight.seen({3600 * microseconds_per_second});
    ASSERT_TRUE(seen.state.boxes.contains({2}));
    EXPECT_TRUE(has_hull(seen.state.boxes.at({2})->hull));
    EXPECT_EQ(seen.report.largest_error, 0.0F);
    EXPECT_EQ(seen.report.left_out.trains, 0U) << "her empty train is not one that is missed";
    size_t patches = 0;
    for (const auto& [key, patch] : seen.state.patches)
        for (const PatchBox& box : patch.boxes) {
            patches += box.box == BoxId{2} ? 1U : 0U;
            EXPECT_EQ(box.train_count, 0) << "nobody needs to evaluate it";
        }
    EXPECT_GT(patches, 0U);
    EXPECT_LE(patches, 40U) << "only where she lies";
    // Not where the camera looks away, nor so far off that she is less than a dot.
    sight.view.qy = 1.0F;
    sight.view.qw = 0.0F;
    EXPECT_FALSE(sight.seen({3600 * microseconds_per_second}).state.boxes.contains({2}));
    sight.view.qy = 0.0F;
    sight.view.qw = 1.0F;
    sight.view.position.z = to_lattice(1'500'000);
    EXPECT_FALSE(sight.seen({3600 * microseconds_per_second}).state.boxes.contains({2}));
}

/// Her waves of 0.16 m are too short to be told from 300 m away; she herself is not.
TEST(LiveBoxes, ASlowShipIsToldForHerHull) {
    const ShipInSight sight(0.5F, false);
    const CullResult seen = sight.seen({600 * microseconds_per_second});
    ASSERT_TRUE(seen.state.boxes.contains({1}));
    EXPECT_EQ(seen.state.boxes.at({1})->hull.length, 120.0F);
}

}  // namespace
}  // namespace trochoid
