#include <gtest/gtest.h>

#include <cmath>

#include "protocol/model/point_query.hpp"
#include "tests/unit/interest/sample_world.hpp"

namespace trochoid {
namespace {

LatticePoint in_disc(const SyncRegion& region, Dice& dice) {
    for (;;) {
        const double r = to_metres(region.radius);
        const double x = dice.between(-r, r), z = dice.between(-r, r);
        if (x * x + z * z <= r * r) return {region.centre.x + to_lattice(x), region.centre.z + to_lattice(z)};
    }
}

TEST(SyncRegion, StateAloneGivesTheWorldsBits) {
    WorldState world = eight_box_world();
    Dice dice(31);
    for (int i = 0; i < 12; ++i) {
        // Looks away from the regions, which lie across box edges and the land fields' border.
        CullKey key = key_around(looking({to_lattice(30e3), 0}, 20.0, 1.57, 0.0));
        for (int j = 0; j < 2; ++j)
            key.regions.push_back({{dice.lattice(-4000.0, 9000.0), dice.lattice(-4000.0, 4000.0)},
                                   static_cast<uint32_t>(dice.lattice(5.0, 2000.0))});
        const Sea sea = sea_of(cull(world, key).state);
        for (int k = 0; k < 4; ++k) {
            const SeaTime t = key.from + static_cast<int64_t>(dice.between(-500e6, 3000e6));
            const SeaInstant theirs(sea, t);
            const SeaInstant ours(world.sea, t);
            for (const SyncRegion& region : key.regions)
                for (int n = 0; n < 60; ++n) {
                    const LatticePoint p = in_disc(region, dice);
                    ASSERT_EQ(theirs.evaluate(p), ours.evaluate(p));
                    ASSERT_EQ(water_at(theirs, p), water_at(ours, p));
                }
        }
    }
}

TEST(SyncRegion, HoldsTheWholeTrainsOfItsBoxesButOnlyThose) {
    SampleBox here, far_away;
    here.id = 1;
    here.origin = {to_lattice(-5000.0), to_lattice(-5000.0)};
    here.heading = 0.0;
    here.length = here.width = 10'000.0;
    far_away = here;
    far_away.id = 2;
    far_away.origin = {to_lattice(500e3), 0};
    CullKey key = key_around(looking({to_lattice(-300e3), 0}, 20.0, 0.0, 0.0));
    const WorldState world = sample_world({here, far_away}, 6);
    EXPECT_TRUE(cull(world, key).state.boxes.empty());
    key.regions.push_back({{0, 0}, 100 << 10});
    const InterestState state = cull(world, key).state;
    ASSERT_EQ(state.boxes.size(), 1U);
    EXPECT_EQ(*state.boxes.at({1}), world.boxes.at({1})->sea->record);
}

TEST(SyncRegion, KeepsBoxesOfTheNearPastAndOfTheFuture) {
    CullKey key = key_around(looking({to_lattice(-300e3), 0}, 20.0, 0.0, 0.0));
    key.regions.push_back({{0, 0}, 100 << 10});
    SampleBox just_over, long_over, unborn;
    just_over.id = 1;
    just_over.end = key.from - sync_history_us;
    long_over.id = 2;
    long_over.end = key.from - sync_history_us - long_over.decay_us;
    unborn.id = 3;
    unborn.begin = key.until + 1'000'000'000;
    const InterestState state = cull(sample_world({just_over, long_over, unborn}, 10), key).state;
    EXPECT_TRUE(state.boxes.contains({1}));
    EXPECT_FALSE(state.boxes.contains({2}));
    EXPECT_TRUE(state.boxes.contains({3}));
}

TEST(SyncRegion, BlocksReachAsFarAsNewtonStepsMay) {
    SampleBox box;
    box.land = true;
    const WorldState world = sample_world({box}, 7);
    CullKey key = key_around(looking({to_lattice(-300e3), 0}, 20.0, 0.0, 0.0));
    // Blocks are 1024 m; from 100 m inside the block (0, 0), 256 m reach the three neighbours to the north-west.
    key.regions.push_back({{to_lattice(110.0), to_lattice(110.0)}, 10 << 10});
    EXPECT_EQ(cull(world, key).state.blocks.size(), 2U * 4U);
    key.regions[0].centre = {to_lattice(500.0), to_lattice(500.0)};
    EXPECT_EQ(cull(world, key).state.blocks.size(), 2U * 1U);
}

}  // namespace
}  // namespace trochoid
