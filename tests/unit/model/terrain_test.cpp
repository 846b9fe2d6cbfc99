#include "protocol/model/terrain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "protocol/model/terrain_file.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

/// A rough grid that is no multiple of a tile, off the origin, from a fixed stream of numbers.
TerrainGrid rough_grid(uint32_t columns, uint32_t rows, uint32_t spacing_log2 = 12, int32_t step_log2 = 5) {
    TerrainGrid grid;
    grid.origin_x = -37 * (int64_t{1} << spacing_log2);
    grid.origin_z = 11 * (int64_t{1} << spacing_log2);
    grid.spacing_log2 = spacing_log2;
    grid.columns = columns;
    grid.rows = rows;
    grid.height_step_log2 = step_log2;
    grid.open_sea_depth = -50'000;
    grid.projection = "+proj=tmerc";
    grid.provenance = "numbers";
    for (uint64_t i = 0; i < uint64_t{columns} * rows; ++i)
        grid.heights.push_back(static_cast<int16_t>(splitmix64(i) >> 48));
    return grid;
}

/// The definition of height_at in doubles, which are exact here: 16 + 2 * 12 bits, divided by powers of two.
double slow_inside(const TerrainGrid& grid, double column, double row) {
    const double c = std::min(std::floor(column), grid.columns - 2.0);
    const double r = std::min(std::floor(row), grid.rows - 2.0);
    const auto at = [&](double i, double j) {
        return double(grid.heights[static_cast<std::size_t>(j * grid.columns + i)]);
    };
    const double fx = column - c;
    const double fz = row - r;
    const double north = at(c, r) * (1 - fx) + at(c + 1, r) * fx;
    const double south = at(c, r + 1) * (1 - fx) + at(c + 1, r + 1) * fx;
    return std::floor((north * (1 - fz) + south * fz) * std::exp2(grid.height_step_log2) + 0.5);
}

double slow_height(const TerrainGrid& grid, int64_t x, int64_t z) {
    const double spacing = std::exp2(grid.spacing_log2);
    const double column = static_cast<double>(x - grid.origin_x) / spacing;
    const double row = static_cast<double>(z - grid.origin_z) / spacing;
    const double near_column = std::clamp(column, 0.0, grid.columns - 1.0);
    const double near_row = std::clamp(row, 0.0, grid.rows - 1.0);
    const double edge = slow_inside(grid, near_column, near_row);
    const double away = std::min(64.0, std::max(std::fabs(column - near_column), std::fabs(row - near_row)));
    return edge + std::floor((grid.open_sea_depth - edge) * away / 64.0 + 0.5);
}

TEST(Terrain, HeightEqualsTheSlowTwinInsideAndOutside) {
    for (const uint32_t spacing_log2 : {0U, 3U, 12U}) {
        const TerrainGrid grid = rough_grid(23, 17, spacing_log2);
        const auto extent = static_cast<uint64_t>(23 + 2 * 80) << spacing_log2;
        for (uint64_t i = 0; i < 20'000; ++i) {
            const int64_t x = grid.origin_x - (int64_t{80} << spacing_log2) +
                              static_cast<int64_t>(splitmix64(2 * i) % extent);
            const int64_t z = grid.origin_z - (int64_t{80} << spacing_log2) +
                              static_cast<int64_t>(splitmix64(2 * i + 1) % extent);
            ASSERT_EQ(height_at(grid, x, z), slow_height(grid, x, z))
                << x << ' ' << z << " spacing 2^" << spacing_log2;
        }
    }
}

TEST(Terrain, HeightAtSamplesIsTheSample) {
    const TerrainGrid grid = rough_grid(9, 5);
    for (uint32_t row = 0; row < grid.rows; ++row)
        for (uint32_t column = 0; column < grid.columns; ++column)
            EXPECT_EQ(height_at(grid, grid.origin_x + (int64_t{column} << 12),
                                grid.origin_z + (int64_t{row} << 12)),
                      grid.heights[row * grid.columns + column] * 32);
}

TEST(Terrain, HeightIsContinuousAcrossTheBorderAndReachesTheOpenSea) {
    const TerrainGrid grid = rough_grid(9, 9);
    const int64_t spacing = 1 << 12;
    const int64_t belt = 64 * spacing;
    const int64_t east_border = grid.origin_x + 8 * spacing;
    // The steepest slopes: two samples 65,535 counts apart inside; border to open sea over the belt outside.
    const int64_t steepest_step = 65'535 * 32 / spacing + 1;
    for (int64_t x = east_border - 50; x < east_border + 50; ++x)
        EXPECT_LE(
            std::abs(height_at(grid, x + 1, grid.origin_z + 777) - height_at(grid, x, grid.origin_z + 777)),
            steepest_step);
    for (const int64_t far : {belt, belt + 1, int64_t{1} << 35}) {
        EXPECT_EQ(height_at(grid, east_border + far, grid.origin_z), -50'000);
        EXPECT_EQ(height_at(grid, grid.origin_x - far, grid.origin_z), -50'000);
        EXPECT_EQ(height_at(grid, grid.origin_x, grid.origin_z - far), -50'000);
        EXPECT_EQ(height_at(grid, east_border + 5, grid.origin_z + 8 * spacing + far), -50'000);
    }
}

TEST(Terrain, LargestLegalNumbersDoNotOverflow) {
    TerrainGrid grid = rough_grid(3, 3, 20, 10);
    grid.open_sea_depth = -(1 << 24);
    for (int16_t& height : grid.heights) height = INT16_MIN;
    ASSERT_EQ(terrain_fault(grid), nullptr);
    EXPECT_EQ(height_at(grid, grid.origin_x + 12'345, grid.origin_z + 54'321), -(32'768 << 10));
    for (int16_t& height : grid.heights) height = INT16_MAX;
    EXPECT_EQ(height_at(grid, grid.origin_x - 1, grid.origin_z - 1), (32'767 << 10) - 1);
    EXPECT_EQ(height_at(grid, int64_t{1} << 36, -(int64_t{1} << 36)), -(1 << 24));
}

TEST(Terrain, FaultNamesEachBrokenRange) {
    const TerrainGrid good = rough_grid(4, 4);
    ASSERT_EQ(terrain_fault(good), nullptr);
    const auto faulty = [&](auto change) {
        TerrainGrid grid = good;
        change(grid);
        return terrain_fault(grid) != nullptr;
    };
    EXPECT_TRUE(faulty([](TerrainGrid& g) { g.spacing_log2 = 21; }));
    EXPECT_TRUE(faulty([](TerrainGrid& g) { g.height_step_log2 = -1; }));
    EXPECT_TRUE(faulty([](TerrainGrid& g) { g.height_step_log2 = 11; }));
    EXPECT_TRUE(faulty([](TerrainGrid& g) { g.columns = 1; }));
    EXPECT_TRUE(faulty([](TerrainGrid& g) { g.rows = 16'386; }));
    EXPECT_TRUE(faulty([](TerrainGrid& g) { g.heights.pop_back(); }));
    EXPECT_TRUE(faulty([](TerrainGrid& g) { g.origin_x += 1; }));
    EXPECT_TRUE(faulty([](TerrainGrid& g) { g.origin_z = int64_t{1} << 35; }));
    EXPECT_TRUE(faulty([](TerrainGrid& g) { g.origin_z = INT64_MIN; }));
    EXPECT_TRUE(faulty([](TerrainGrid& g) { g.open_sea_depth = 0; }));
    EXPECT_TRUE(faulty([](TerrainGrid& g) { g.open_sea_depth = INT32_MIN; }));
    EXPECT_TRUE(faulty([](TerrainGrid& g) { g.origin_lat = std::nan(""); }));
    EXPECT_TRUE(faulty([](TerrainGrid& g) { g.origin_lon = 181.0; }));
}

TEST(TerrainTiles, LevelsCoverTheGridUpToOneTile) {
    for (const auto& [columns, rows, levels] : std::vector<std::tuple<uint32_t, uint32_t, uint32_t>>{
             {2, 2, 1}, {65, 65, 1}, {66, 3, 2}, {129, 40, 2}, {130, 9, 3}, {3, 641, 5}}) {
        const TerrainGrid grid = rough_grid(columns, rows);
        EXPECT_EQ(tile_levels(grid), levels) << columns << " x " << rows;
        EXPECT_EQ(tiles_at_level(grid, levels - 1).size(), 1U);
        EXPECT_TRUE(tiles_at_level(grid, levels).empty());
        const std::size_t across = (columns - 1 + 63) / 64;
        const std::size_t down = (rows - 1 + 63) / 64;
        EXPECT_EQ(tiles_at_level(grid, 0).size(), across * down);
    }
}

TEST(TerrainTiles, SharedNodesAgreeAtAllLevels) {
    const TerrainGrid grid = rough_grid(150, 200);
    std::map<std::pair<int64_t, int64_t>, int16_t> seen;
    std::size_t met_again = 0;
    for (uint32_t level = 0; level < tile_levels(grid); ++level) {
        for (const TerrainTileKey& key : tiles_at_level(grid, level)) {
            const TerrainTile tile = make_tile(grid, key);
            ASSERT_EQ(tile.heights.size(), 65U * 65U);
            EXPECT_EQ(tile.spacing_log2, grid.spacing_log2 + level);
            for (int64_t i = 0; i < 65 * 65; ++i) {
                const int64_t x = tile.origin_x + ((i % 65) << tile.spacing_log2);
                const int64_t z = tile.origin_z + ((i / 65) << tile.spacing_log2);
                const int16_t height = tile.heights[static_cast<std::size_t>(i)];
                const auto [place, fresh] = seen.try_emplace({x, z}, height);
                if (!fresh) ++met_again;
                ASSERT_EQ(place->second, height) << "level " << level << " at " << x << ',' << z;
            }
        }
    }
    EXPECT_GT(met_again, 10'000U);
}

TEST(TerrainTiles, SamplesAreTheGridsAndBeyondItTheBelts) {
    const TerrainGrid grid = rough_grid(100, 70);
    const TerrainTile tile = make_tile(grid, {0, 1, 1});
    EXPECT_EQ(tile.origin_x, grid.origin_x + (int64_t{64} << 12));
    for (int64_t row = 0; row < 65; ++row) {
        for (int64_t column = 0; column < 65; ++column) {
            const int64_t height = tile.heights[static_cast<std::size_t>(row * 65 + column)];
            const int64_t units =
                height_at(grid, tile.origin_x + (column << 12), tile.origin_z + (row << 12));
            if (column < 36 && row < 6)
                ASSERT_EQ(height, grid.heights[static_cast<std::size_t>((64 + row) * 100 + 64 + column)]);
            else
                ASSERT_EQ(height, std::floor(static_cast<double>(units) / 32.0 + 0.5));
        }
    }
}

/// Height of a drawn triangle at (i, j) of a cell of n, by weights; the diagonal falls or rises.
double triangle_height(const double (&corner)[2][2], double n, double i, double j, bool falling) {
    const double u = i / n;
    const double v = falling ? j / n : 1.0 - j / n;
    const double a = falling ? corner[0][0] : corner[1][0];
    const double b = falling ? corner[0][1] : corner[1][1];
    const double c = falling ? corner[1][0] : corner[0][0];
    const double d = falling ? corner[1][1] : corner[0][1];
    return u >= v ? a + u * (b - a) + v * (d - b) : a + v * (c - a) + u * (d - c);
}

double slow_error(const TerrainGrid& grid, TerrainTileKey key) {
    const int64_t n = int64_t{1} << key.level;
    double worst = 0.0;
    for (int64_t row = 0; row <= 64 * n; ++row) {
        for (int64_t column = 0; column <= 64 * n; ++column) {
            const int64_t c = key.x * 64 * n + column;
            const int64_t r = key.z * 64 * n + row;
            const int64_t c0 = key.x * 64 * n + std::min(column / n, int64_t{63}) * n;
            const int64_t r0 = key.z * 64 * n + std::min(row / n, int64_t{63}) * n;
            const double corner[2][2] = {
                {double(height_count_at(grid, c0, r0)), double(height_count_at(grid, c0 + n, r0))},
                {double(height_count_at(grid, c0, r0 + n)), double(height_count_at(grid, c0 + n, r0 + n))}};
            for (const bool falling : {true, false}) {
                const double drawn =
                    triangle_height(corner, double(n), double(c - c0), double(r - r0), falling);
                worst = std::max(worst, std::fabs(drawn - height_count_at(grid, c, r)));
            }
        }
    }
    return std::ceil(worst * std::exp2(grid.height_step_log2));
}

TEST(TerrainTiles, GeometricErrorIsTheLargestDistanceAndNeverBelowAChilds) {
    const TerrainGrid grid = rough_grid(200, 140);
    for (uint32_t level = 0; level < tile_levels(grid); ++level) {
        for (const TerrainTileKey& key : tiles_at_level(grid, level)) {
            double expected = slow_error(grid, key);
            if (level > 0)
                for (int32_t child = 0; child < 4; ++child)
                    expected = std::max(expected, double(tile_geometric_error(
                                                      grid, {static_cast<uint8_t>(level - 1),
                                                             2 * key.x + child % 2, 2 * key.z + child / 2})));
            EXPECT_EQ(tile_geometric_error(grid, key), expected)
                << "level " << level << " tile " << key.x << ',' << key.z;
            EXPECT_EQ(tile_geometric_error(grid, key) == 0, level == 0);
        }
    }
}

TEST(TerrainTiles, AFlatSlopeHasNoError) {
    TerrainGrid grid = rough_grid(129, 129);
    for (std::size_t i = 0; i < grid.heights.size(); ++i)
        grid.heights[i] = static_cast<int16_t>(5 * (i % 129) - 7 * (i / 129));
    EXPECT_EQ(tile_geometric_error(grid, {1, 0, 0}), 0);
}

TEST(TerrainTiles, HashIsFnvOverLittleEndianBytes) {
    const TerrainTile tile = make_tile(rough_grid(70, 70), {1, 0, 0});
    std::vector<uint8_t> bytes{1};
    const auto put = [&](uint64_t value, int count) {
        for (int i = 0; i < count; ++i) bytes.push_back(static_cast<uint8_t>(value >> (8 * i)));
    };
    put(0, 8);
    put(static_cast<uint64_t>(tile.origin_x), 8);
    put(static_cast<uint64_t>(tile.origin_z), 8);
    put(tile.spacing_log2, 4);
    put(static_cast<uint32_t>(tile.height_step_log2), 4);
    for (const int16_t height : tile.heights) put(static_cast<uint16_t>(height), 2);
    uint64_t expected = 14695981039346656037ULL;
    for (const uint8_t byte : bytes) expected = (expected ^ byte) * 1099511628211ULL;
    EXPECT_EQ(tile_hash(tile), expected);
    TerrainTile other = tile;
    other.heights.back() ^= 1;
    EXPECT_NE(tile_hash(other), tile_hash(tile));
}

TEST(TerrainFile, RoundTripKeepsEveryMember) {
    TerrainGrid grid = rough_grid(33, 21, 15, 7);
    grid.origin_lon = -6.345;
    grid.origin_lat = 49.92;
    grid.projection = "+proj=tmerc +lat_0=49.92";
    grid.provenance = "Küste, synthetic";
    const Result<TerrainGrid> back = decode_terrain(encode_terrain(grid));
    ASSERT_TRUE(back);
    EXPECT_EQ(*back, grid);
}

TEST(TerrainFile, BytesArePinned) {
    TerrainGrid grid;
    grid.origin_x = -32'768;
    grid.spacing_log2 = 15;
    grid.columns = grid.rows = 2;
    grid.heights = {1, -2, 300, -32'768};
    grid.projection = "p";
    grid.origin_lon = 1.0;
    const std::vector<uint8_t> bytes = encode_terrain(grid);
    const std::vector<uint8_t> start{'T', 'R', 'O', 'C',  'H',  'T',  'E',  'R',  1,    0,
                                     0,   0,   0,   0x80, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff};
    ASSERT_EQ(bytes.size(), 8U + 4 + 16 + 12 + 8 + 16 + 3 + 2 + 8 + 8);
    EXPECT_TRUE(std::equal(start.begin(), start.end(), bytes.begin()));
    const std::vector<uint8_t> heights{1, 0, 0xfe, 0xff, 0x2c, 0x01, 0x00, 0x80};
    EXPECT_TRUE(std::equal(heights.begin(), heights.end(), bytes.end() - 16));
    uint64_t hash = 14695981039346656037ULL;
    for (std::size_t i = 0; i + 8 < bytes.size(); ++i) hash = (hash ^ bytes[i]) * 1099511628211ULL;
    EXPECT_EQ(terrain_hash(grid), hash);
}

TEST(TerrainFile, EveryTornEndIsRefused) {
    const std::vector<uint8_t> bytes = encode_terrain(rough_grid(6, 5));
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        const Result<TerrainGrid> torn = decode_terrain(std::span(bytes).first(length));
        ASSERT_FALSE(torn) << length;
        EXPECT_EQ(torn.error().code, length < 8 ? ErrorCode::wrong_magic : ErrorCode::malformed_frame)
            << length;
    }
    std::vector<uint8_t> longer = bytes;
    longer.push_back(0);
    EXPECT_EQ(decode_terrain(longer).error().code, ErrorCode::trailing_bytes);
}

TEST(TerrainFile, EveryFlippedBitIsRefused) {
    const std::vector<uint8_t> bytes = encode_terrain(rough_grid(6, 5));
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        std::vector<uint8_t> damaged = bytes;
        damaged[bit / 8] = static_cast<uint8_t>(damaged[bit / 8] ^ (1U << (bit % 8)));
        ASSERT_FALSE(decode_terrain(damaged)) << "bit " << bit;
    }
}

/// Bytes with a member overwritten and the closing hash mended, as a malicious writer would.
std::vector<uint8_t> forged(std::size_t offset, uint64_t value, int count) {
    std::vector<uint8_t> bytes = encode_terrain(rough_grid(6, 5));
    for (int i = 0; i < count; ++i)
        bytes[offset + static_cast<std::size_t>(i)] = static_cast<uint8_t>(value >> (8 * i));
    uint64_t hash = Hash64().bytes(std::span(bytes).first(bytes.size() - 8)).value();
    for (std::size_t i = bytes.size() - 8; i < bytes.size(); ++i, hash >>= 8)
        bytes[i] = static_cast<uint8_t>(hash);
    return bytes;
}

TEST(TerrainFile, ForgedMembersWithAGoodHashAreRefused) {
    EXPECT_EQ(decode_terrain(forged(8, 2, 4)).error().code, ErrorCode::protocol_version);
    EXPECT_EQ(decode_terrain(forged(12, 1, 8)).error().code,
              ErrorCode::value_out_of_range);  // origin off the spacing
    EXPECT_EQ(decode_terrain(forged(28, 99, 4)).error().code, ErrorCode::value_out_of_range);       // spacing
    EXPECT_EQ(decode_terrain(forged(32, 0xffffffff, 4)).error().code, ErrorCode::malformed_frame);  // columns
    EXPECT_EQ(decode_terrain(forged(32, 0, 4)).error().code, ErrorCode::trailing_bytes);            // columns
    EXPECT_EQ(decode_terrain(forged(40, 0x80000000, 4)).error().code,
              ErrorCode::value_out_of_range);  // height step
    EXPECT_EQ(decode_terrain(forged(44, 5, 4)).error().code,
              ErrorCode::value_out_of_range);  // open sea on land
    EXPECT_EQ(decode_terrain(forged(48, 0x7ff8000000000000, 8)).error().code,
              ErrorCode::value_out_of_range);  // longitude NaN
    EXPECT_EQ(decode_terrain(forged(64, 0xffff, 2)).error().code, ErrorCode::malformed_frame);  // text length
}

}  // namespace
}  // namespace trochoid
