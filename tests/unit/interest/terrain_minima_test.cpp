#include "server/interest/terrain_minima.hpp"

#include <gtest/gtest.h>

#include "tests/unit/interest/sample_world.hpp"

namespace trochoid {
namespace {

TEST(TerrainMinima, AgreesWithEverySampleUnderTheRectangle) {
    const auto grid = island(2000.0);
    const TerrainMinima minima(grid);
    Dice dice(6);
    int above = 0;
    for (int i = 0; i < 3000; ++i) {
        const LatticePoint a{dice.lattice(-3000.0, 3000.0), dice.lattice(-3000.0, 3000.0)};
        const int64_t side = dice.lattice(1.0, 900.0);
        const LatticeRect rect{a, {a.x + side, a.z + side}};
        const int64_t height = dice.lattice(-5.0, 60.0);
        // The twin: all samples of the cells that the rectangle touches.
        const int64_t n = int64_t{1} << grid->spacing_log2;
        bool expected = true;
        for (int64_t z = (rect.min.z - grid->origin_z) / n; z <= (rect.max.z - grid->origin_z) / n + 1; ++z)
            for (int64_t x = (rect.min.x - grid->origin_x) / n; x <= (rect.max.x - grid->origin_x) / n + 1;
                 ++x)
                expected =
                    expected && height_at(*grid, grid->origin_x + x * n, grid->origin_z + z * n) > height;
        above += expected ? 1 : 0;
        ASSERT_EQ(minima.all_above(rect, height), expected);
        for (int j = 0; expected && j < 20; ++j) {
            const LatticePoint p = dice.point_in(rect);
            ASSERT_GT(height_at(*grid, p.x, p.z), height);
        }
    }
    EXPECT_GT(above, 100);
}

TEST(TerrainMinima, NothingOutsideTheGridIsAbove) {
    auto grid = std::make_shared<TerrainGrid>(*island(2000.0));
    for (int16_t& h : grid->heights) h = 32 * 100;
    const TerrainMinima minima(grid);
    const int64_t edge = 256 * 32 * lattice_per_metre;
    EXPECT_TRUE(minima.all_above({{-edge, -edge}, {edge, edge}}, 0));
    EXPECT_FALSE(minima.all_above({{-edge, -edge}, {edge + 1, edge}}, 0));
    EXPECT_FALSE(minima.all_above({{-edge, -edge}, {edge, edge}}, to_lattice(100.0)));
    EXPECT_TRUE(minima.all_above({{-edge, -edge}, {edge, edge}}, to_lattice(100.0) - 1));
}

}  // namespace
}  // namespace trochoid
