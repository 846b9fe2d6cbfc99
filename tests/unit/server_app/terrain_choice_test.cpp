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

// After a change the choice is the one that a new start with the changed grid would make, and only touched tiles are new.
TEST(TerrainChoices, AChangeTouchesItsTilesAlone) {
    const auto grid = rough_grid();
    const TerrainChoice before(grid);
    auto changed = std::make_shared<TerrainGrid>(*grid);
    constexpr int64_t sample = 32768;
    for (size_t row = 100; row < 110; ++row)
        for (size_t column = 200; column < 220; ++column) changed->heights[row * 513 + column] = 30000;
    const LatticeRect touched{{199 * sample, 99 * sample}, {220 * sample, 110 * sample}};
    const TerrainChoice after(before, changed, touched);
    const TerrainChoice fresh(changed);
    for (const ViewState& view : {view_at(300, 300, 20), view_at(6700, 3300, 200), view_at(-90000, 0, 9000)})
        EXPECT_EQ(after.tiles_for(view), fresh.tiles_for(view));
    int outdated = 0;
    for (uint32_t level = 0; level < tile_levels(*grid); ++level)
        for (const TerrainTileKey& key : tiles_at_level(*grid, level)) {
            EXPECT_EQ(before.revision(key), 0U);
            if (after.tile(key) != before.tile(key)) {
                EXPECT_EQ(after.revision(key), 1U);
            }
            outdated += after.revision(key) != 0 ? 1 : 0;
        }
    EXPECT_GE(outdated, 4) << "one a level at least";
    EXPECT_LE(outdated, 8);
    const TerrainChoice again(after, changed, touched);
    EXPECT_EQ(again.revision({0, 3, 1}), 2U);
    EXPECT_EQ(again.revision({0, 0, 0}), 0U);
}

// Against a slow obvious twin that remembers every change.
TEST(TerrainChoices, ATilesRevisionIsItsLastChange) {
    const auto grid = rough_grid();
    auto choice = std::make_unique<TerrainChoice>(grid);
    std::vector<LatticeRect> changes;
    uint64_t state = 7;
    const auto dice = [&](uint64_t sides) {
        return static_cast<int64_t>((state = splitmix64(state)) % sides);
    };
    for (int i = 0; i < 60; ++i) {
        const LatticePoint corner{dice(500) * 32768, dice(500) * 32768};
        changes.push_back({corner, {corner.x + (1 + dice(90)) * 32768, corner.z + (1 + dice(90)) * 32768}});
        choice = std::make_unique<TerrainChoice>(*choice, grid, changes.back());
    }
    size_t touched = 0;
    for (uint32_t level = 0; level < tile_levels(*grid); ++level)
        for (const TerrainTileKey& key : tiles_at_level(*grid, level)) {
            const int64_t side = int64_t{terrain_tile_cells} << (key.level + grid->spacing_log2);
            const LatticeRect rect{{key.x * side, key.z * side}, {(key.x + 1) * side, (key.z + 1) * side}};
            uint32_t last = 0;
            for (uint32_t i = 0; i < changes.size(); ++i)
                if (overlap(rect, changes[i])) last = i + 1;
            EXPECT_EQ(choice->revision(key), last);
            touched += last != 0 ? 1U : 0U;
        }
    EXPECT_GT(touched, 20U);
}

}  // namespace
}  // namespace trochoid
