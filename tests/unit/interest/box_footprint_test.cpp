#include "server/interest/box_footprint.hpp"

#include <gtest/gtest.h>

#include "tests/unit/interest/sample_world.hpp"

namespace trochoid {
namespace {

TEST(BoxFootprint, TouchesWhereverTheEnvelopeIsNotZero) {
    Dice dice(7);
    int inside = 0, apart = 0;
    for (int i = 0; i < 300; ++i) {
        SampleBox what;
        what.origin = {dice.lattice(-4e6, 4e6), dice.lattice(-4e6, 4e6)};
        what.heading = dice.between(0.0, 6.3);
        what.length = i % 5 == 0 ? 0.0 : dice.between(1100.0, 60'000.0);
        what.width = i % 7 == 0 ? 0.0 : dice.between(1100.0, 60'000.0);
        what.front_speed = i % 3 == 0 && what.length > 0.0 ? 17180 * 10 : 0;
        what.trains = 2;
        const auto box = sample_box(what, dice);
        WorldState world;
        world.boxes[{1}] = box;
        const InterestIndex index(world);
        const LatticePoint anchor{what.origin.x + dice.lattice(-40e3, 40e3),
                                  what.origin.z + dice.lattice(-40e3, 40e3)};
        const SeaTime from{dice.lattice(0.0, 2e6)};
        const BoxFootprint f = footprint_over(*index.boxes()[0], anchor, from, from + 60'000'000);
        const BoxInstant instant = instant_of(box->sea->record, from + 59'999'999);
        for (int j = 0; j < 300; ++j) {
            const LatticePoint p{what.origin.x + dice.lattice(-70e3, 70e3),
                                 what.origin.z + dice.lattice(-70e3, 70e3)};
            const PatchKey patch = patch_at(p, static_cast<uint8_t>(15 + j % 8));
            const bool touched = touches(f, square_on_sea(rect_of(patch), anchor, 0.0));
            apart += touched ? 0 : 1;
            if (envelope_at(box->sea->record, instant, p).gain == 0) continue;
            ++inside;
            EXPECT_TRUE(touched);
        }
    }
    EXPECT_GT(inside, 3000);
    EXPECT_GT(apart, 3000);
}

TEST(BoxFootprint, SeparatesAnObliqueBoxWhoseBoundingSquareOverlaps) {
    Dice dice(8);
    SampleBox what;
    what.heading = 0.785398;
    what.length = 20'000.0;
    what.width = 1100.0;
    WorldState world;
    world.boxes[{1}] = sample_box(what, dice);
    const InterestIndex index(world);
    const BoxFootprint f = whole_footprint(*index.boxes()[0], {0, 0}, SeaTime{0});
    EXPECT_TRUE(touches(f, {7000.0, 7000.0, 32.0}));
    EXPECT_FALSE(touches(f, {10'000.0, 2000.0, 32.0}));
}

TEST(BoxFootprint, ShareBoundsTheTimePartAndGrowsInSixteenths) {
    Dice dice(9);
    for (int i = 0; i < 400; ++i) {
        WaveTrainBox box;
        box.begin = {dice.lattice(-1e3, 1e3)};
        box.build_up_us = dice.lattice(0.0, 2e3);
        box.end = box.begin + dice.lattice(0.0, 3e3);
        box.decay_us = dice.lattice(0.0, 2e3);
        if (i % 3 == 0) {
            box.raised_us = dice.lattice(0.0, 3e3);
            box.fade_us = dice.lattice(0.0, 1e3);
        }
        const SeaTime from{dice.lattice(-3e3, 6e3)};
        const SeaTime until = from + dice.lattice(1.0, 500.0);
        const double share = largest_share(box, from, until);
        EXPECT_EQ(share * 16.0, static_cast<double>(static_cast<int>(share * 16.0)));
        for (int j = 0; j < 50; ++j) {
            const SeaTime t =
                from + static_cast<int64_t>(dice.between(0.0, 1.0) * static_cast<double>(until - from));
            EXPECT_GE(share * full_gain, instant_of(box, t).time_gain);
        }
    }
}

}  // namespace
}  // namespace trochoid
