#include "client/scene/terrain_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "client/scene/camera_floor.hpp"

namespace trochoid {
namespace {

constexpr FrustumPlanes everything{glm::vec4(0, 0, 0, 1), glm::vec4(0, 0, 0, 1), glm::vec4(0, 0, 0, 1),
                                   glm::vec4(0, 0, 0, 1), glm::vec4(0, 0, 0, 1)};

TerrainGrid hills() {
    TerrainGrid grid;
    grid.origin_x = grid.origin_z = -(int64_t{128} << 15);
    grid.columns = grid.rows = 257;
    grid.heights.resize(257 * 257);
    for (size_t row = 0; row < 257; ++row)
        for (size_t column = 0; column < 257; ++column)
            grid.heights[row * 257 + column] =
                static_cast<int16_t>(320 + 200 * std::sin(0.05 * static_cast<double>(row)) *
                                               std::cos(0.07 * static_cast<double>(column)));
    return grid;
}

std::vector<std::shared_ptr<const TerrainTile>> tiles_of(const TerrainGrid& grid) {
    std::vector<std::shared_ptr<const TerrainTile>> tiles;
    for (uint32_t level = 0; level < tile_levels(grid); ++level)
        for (const TerrainTileKey& key : tiles_at_level(grid, level))
            tiles.push_back(std::make_shared<const TerrainTile>(make_tile(grid, key)));
    return tiles;
}

/// Cells of the finest level that a selection draws, and how often.
std::map<std::pair<int64_t, int64_t>, int> coverage(const TerrainSelection& selection,
                                                    const TerrainGrid& grid) {
    std::map<std::pair<int64_t, int64_t>, int> drawn;
    for (const TerrainDraw& draw : selection.draws) {
        const int64_t cells = int64_t{terrain_tile_cells / 2} << draw.tile->key.level;
        const int64_t x =
            ((draw.tile->origin_x - grid.origin_x) >> grid.spacing_log2) + (draw.quadrant & 1U ? cells : 0);
        const int64_t z =
            ((draw.tile->origin_z - grid.origin_z) >> grid.spacing_log2) + (draw.quadrant >> 1U ? cells : 0);
        for (int64_t j = 0; j < cells; j += 8)
            for (int64_t i = 0; i < cells; i += 8) ++drawn[{x + i, z + j}];
    }
    return drawn;
}

void expect_covered_once(const TerrainSelection& selection, const TerrainGrid& grid) {
    const auto drawn = coverage(selection, grid);
    for (int64_t z = 0; z < 256; z += 8)
        for (int64_t x = 0; x < 256; x += 8) {
            const auto at = drawn.find({x, z});
            ASSERT_TRUE(at != drawn.end()) << x << ' ' << z;
            EXPECT_EQ(at->second, 1) << x << ' ' << z;
        }
}

TEST(SelectTerrain, draws_every_place_once_whatever_tiles_are_known) {
    const TerrainGrid grid = hills();
    const auto all = tiles_of(grid);
    Camera camera;
    camera.altitude_m = 30;
    const CameraFrame frame = frame_of(camera, DepthRange::classic);
    expect_covered_once(select_terrain(all, frame, everything, 0.00135F, 1.0F), grid);
    expect_covered_once(select_terrain(all, frame, everything, 0.00135F, 50.0F), grid);
    // Some fine tiles have not come yet.
    std::vector<std::shared_ptr<const TerrainTile>> some;
    for (const auto& tile : all)
        if (tile->key.level > 0 || (tile->key.x + tile->key.z) % 2 == 0) some.push_back(tile);
    expect_covered_once(select_terrain(some, frame, everything, 0.00135F, 1.0F), grid);
    // Only fine ones have.
    std::vector<std::shared_ptr<const TerrainTile>> fine;
    for (const auto& tile : all)
        if (tile->key.level == 0) fine.push_back(tile);
    expect_covered_once(select_terrain(fine, frame, everything, 0.00135F, 1.0F), grid);
}

TEST(SelectTerrain, is_finer_near_the_camera_and_cheaper_with_more_error) {
    const TerrainGrid grid = hills();
    const auto all = tiles_of(grid);
    const CameraFrame frame = frame_of(Camera{}, DepthRange::classic);
    const TerrainSelection close = select_terrain(all, frame, everything, 0.00135F, 1.0F);
    const TerrainSelection rough = select_terrain(all, frame, everything, 0.00135F, 20.0F);
    EXPECT_LT(rough.triangles, close.triangles / 2);
    uint8_t finest = 9;
    for (const TerrainDraw& draw : close.draws) finest = std::min(finest, draw.tile->key.level);
    EXPECT_EQ(finest, 0);
}

TEST(SelectTerrain, leaves_out_the_deep_bed) {
    TerrainGrid grid = hills();
    for (int16_t& height : grid.heights) height = -20 * 32;
    const CameraFrame frame = frame_of(Camera{}, DepthRange::classic);
    EXPECT_TRUE(select_terrain(tiles_of(grid), frame, everything, 0.00135F, 1.0F).draws.empty());
}

TEST(TerrainIndices, quadrants_use_each_cell_twice_and_stay_inside_the_tile) {
    for (uint32_t stride = 1; stride <= 8; stride *= 2) {
        size_t surface = 0;
        for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) {
            const auto list = terrain_indices(quadrant, stride);
            ASSERT_EQ(list.size() % 3, 0U);
            for (size_t i = 0; i < list.size(); i += 3) {
                for (size_t k = 0; k < 3; ++k) EXPECT_LT(list[i + k], terrain_vertices);
                const bool skirt = std::max({list[i], list[i + 1], list[i + 2]}) >=
                                   terrain_tile_samples * terrain_tile_samples;
                if (!skirt) ++surface;
            }
        }
        EXPECT_EQ(surface, size_t{2} * (terrain_tile_cells / stride) * (terrain_tile_cells / stride));
    }
}

TEST(TerrainVertices, have_heights_normals_and_skirts) {
    TerrainGrid grid = hills();
    // A plane that rises 1 m a metre eastwards: 32 m a sample, 1024 counts.
    for (size_t i = 0; i < grid.heights.size(); ++i)
        grid.heights[i] = static_cast<int16_t>(static_cast<int>(i % 257) * 1024 % 32'000);
    const TerrainTile tile = make_tile(grid, {0, 0, 0});
    const auto vertices = terrain_vertices_of(tile);
    ASSERT_EQ(vertices.size(), terrain_vertices);
    EXPECT_EQ(vertices[5].height, 5 * 1024);
    EXPECT_NEAR(vertices[5].nx, -127 / std::sqrt(2.0), 1.0);
    EXPECT_NEAR(vertices[5].ny, 127 / std::sqrt(2.0), 1.0);
    EXPECT_EQ(vertices[5].skirt, 0);
    EXPECT_EQ(vertices[terrain_tile_samples * terrain_tile_samples + 5].skirt, 1);
    EXPECT_EQ(vertices[terrain_tile_samples * terrain_tile_samples + 5].height, 5 * 1024);
}

TEST(CameraFloor, lifts_out_of_hills_and_waves_only) {
    const TerrainGrid grid = hills();
    SceneInput input;
    input.tiles = tiles_of(grid);
    Camera camera;
    camera.altitude_m = 1;
    CameraFloor floor;
    floor.lift(camera, input);
    EXPECT_GE(camera.altitude_m, to_metres(height_at(grid, 0, 0)) + 1.4);
    camera.altitude_m = 500;
    floor.lift(camera, input);
    EXPECT_EQ(camera.altitude_m, 500);

    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    WaveTrain train;
    train.kx = 42'000;  // about 100 m
    train.amplitude = 4;
    train.phase = 0;  // a crest at the origin at time 0
    train.omega = 1;
    box.trains = {train};
    auto state = std::make_shared<InterestState>();
    state->boxes[box.id] = std::make_shared<const WaveTrainBox>(box);
    SceneInput sea;
    sea.state = state;
    sea.now = {1};
    camera.altitude_m = 1;
    floor.lift(camera, sea);
    EXPECT_NEAR(camera.altitude_m, 4.6, 0.01);
}

}  // namespace
}  // namespace trochoid
