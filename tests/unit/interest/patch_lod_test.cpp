#include "server/interest/patch_lod.hpp"

#include <gtest/gtest.h>

#include <set>

#include "protocol/model/displayed.hpp"
#include "tests/unit/interest/sample_world.hpp"

namespace trochoid {
namespace {

CullKey random_key(Dice& dice) {
    ViewState v =
        looking({dice.lattice(-9e6, 9e6), dice.lattice(-9e6, 9e6)}, dice.between(-5.0, 400.0), 0.0, 0.0);
    v.accepted_error_px = static_cast<float>(dice.between(0.3, 40.0));
    CullKey key = key_around(v);
    key.slack = static_cast<uint32_t>(dice.lattice(0.0, 60.0));
    return key;
}

TEST(PatchLod, NeighboursDifferByOneLevelAtMost) {
    Dice dice(3);
    std::set<int> steps;
    for (int i = 0; i < 60; ++i) {
        const CullKey key = random_key(dice);
        const PatchLod lod(key);
        for (int j = 0; j < 400; ++j) {
            const double scale = 20.0 * (1 << (j % 12));
            const LatticePoint p{key.anchor.position.x + dice.lattice(-scale, scale),
                                 key.anchor.position.z + dice.lattice(-scale, scale)};
            const PatchKey leaf = lod.leaf_at(p);
            const LatticeRect r = rect_of(leaf);
            ASSERT_TRUE(contains(r, p));
            const LatticePoint inside = dice.point_in({r.min, {r.max.x - 1, r.max.z - 1}});
            for (const LatticePoint beside :
                 {LatticePoint{r.min.x - 1, inside.z}, LatticePoint{r.max.x, inside.z},
                  LatticePoint{inside.x, r.min.z - 1}, LatticePoint{inside.x, r.max.z},
                  LatticePoint{r.min.x - 1, r.min.z - 1}, LatticePoint{r.max.x, r.max.z}}) {
                const int step = int{lod.leaf_at(beside).level} - int{leaf.level};
                steps.insert(step);
                ASSERT_LE(std::abs(step), 1);
            }
        }
    }
    EXPECT_EQ(steps.size(), 3U) << "levels that never change prove nothing";
}

TEST(PatchLod, NearPatchesAreFineAndFarOnesKilometres) {
    const PatchLod lod(key_around(looking({0, 0}, 20.0, 0.0, 0.0)));
    EXPECT_EQ(lod.leaf_at({0, 0}).level, 15);
    EXPECT_LE(lod.leaf_at({to_lattice(300.0), 0}).level, 16);
    EXPECT_GE(lod.leaf_at({to_lattice(15'000.0), 0}).level, 20);
    EXPECT_LE(lod.leaf_at({to_lattice(15'000.0), 0}).level, 22);
}

TEST(PatchLod, NinetySixVertexSpacingsCoverEverySide) {
    Dice dice(4);
    for (int i = 0; i < 4000; ++i) {
        const CullKey key = key_around(looking({0, 0}, dice.between(0.0, 300.0), 0.0, 0.0));
        const PatchLod lod(key);
        const PatchKey leaf =
            lod.leaf_at({dice.lattice(-30'000.0, 30'000.0), dice.lattice(-30'000.0, 30'000.0)});
        const double spacing = lod.spacing(lod.distance(rect_of(leaf)));
        EXPECT_LE(to_metres(int64_t{1} << leaf.level), patch_segments * spacing * 1.0001);
    }
}

TEST(PatchLod, DistanceHoldsForEveryCameraInTheSlack) {
    Dice dice(5);
    for (int i = 0; i < 2000; ++i) {
        const CullKey key = random_key(dice);
        const PatchLod lod(key);
        const LatticeRect r = rect_of(patch_at({key.anchor.position.x + dice.lattice(-500.0, 500.0),
                                                key.anchor.position.z + dice.lattice(-500.0, 500.0)},
                                               16));
        const ViewState v = within_slack(key, dice);
        const LatticePoint p = dice.point_in(r);
        const double dx = to_metres(p.x - v.position.x), dz = to_metres(p.z - v.position.z),
                     dy = to_metres(v.altitude);
        const double d = std::sqrt(dx * dx + dy * dy + dz * dz);
        EXPECT_LE(lod.distance(r), d + 1e-3);
        EXPECT_GE(lod.distance(r) + 2.0 * to_metres(key.slack) + 91.0, d);
    }
}

}  // namespace
}  // namespace trochoid
