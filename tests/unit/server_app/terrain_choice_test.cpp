#include "server/app/terrain_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "protocol/units/hash.hpp"
#include "protocol/units/lattice.hpp"

namespace trochoid {
namespace {

// 513 x 513 samples of 32 m: 8 x 8 tiles of level 0, four levels; rough ground.
std::shared_ptr<const TerrainGrid> rough_grid() {
    TerrainGrid grid;
    grid.columns = grid.rows = 513;
    grid.heights.resize(size_t{513} * 513);
    uint64_t state = 1;
    for (int16_t& height : grid.heights) height = static_cast<int16_t>((state = splitmix64(state)) % 4096);
    return std::make_shared<const TerrainGrid>(grid);
}

ViewState view_at(double x, double z, double up) {
    ViewState view;
    view.position = {to_lattice(x), to_lattice(z)};
    view.altitude = static_cast<int32_t>(to_lattice(up));
    return view;
}

TEST(TerrainChoices, WithoutTerrainNothing) {
    EXPECT_TRUE(TerrainChoice(nullptr).tiles_for(ViewState{}).empty());
}

TEST(TerrainChoices, ParentsComeBeforeChildrenAndNothingTwice) {
    const TerrainChoice choice(rough_grid());
    const auto keys = choice.tiles_for(view_at(1000, 1000, 20));
    ASSERT_FALSE(keys.empty());
    EXPECT_EQ(keys.front(), (TerrainTileKey{3, 0, 0}));
    for (size_t i = 1; i < keys.size(); ++i) {
        const TerrainTileKey parent{static_cast<uint8_t>(keys[i].level + 1), keys[i].x / 2, keys[i].z / 2};
        EXPECT_NE(std::find(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(i), parent),
                  keys.begin() + static_cast<std::ptrdiff_t>(i));
        EXPECT_EQ(std::count(keys.begin(), keys.end(), keys[i]), 1);
        EXPECT_LE(keys[i].level, keys[i - 1].level);
    }
}

TEST(TerrainChoices, NearGroundIsFinerAndComesFirst) {
    const TerrainChoice choice(rough_grid());
    const auto keys = choice.tiles_for(view_at(300, 300, 20));
    const auto finest =
        std::find_if(keys.begin(), keys.end(), [](const TerrainTileKey& key) { return key.level == 0; });
    ASSERT_NE(finest, keys.end());
    EXPECT_EQ(*finest, (TerrainTileKey{0, 0, 0})) << "the tile that the camera stands over";
}

TEST(TerrainChoices, FarAwayOrEasilyPleasedTheCoarsestIsEnough) {
    const TerrainChoice choice(rough_grid());
    EXPECT_EQ(choice.tiles_for(view_at(3.0e6, 0, 20)).size(), 1U);
    ViewState coarse = view_at(0, 0, 50000);
    coarse.accepted_error_px = 100;
    EXPECT_EQ(choice.tiles_for(coarse).size(), 1U);
}

TEST(TerrainChoices, TilesAreTheGrids) {
    const auto grid = rough_grid();
    const TerrainChoice choice(grid);
    for (const TerrainTileKey& key : choice.tiles_for(view_at(8000, 8000, 5)))
        EXPECT_EQ(choice.tile(key), make_tile(*grid, key));
}

}  // namespace
}  // namespace trochoid
