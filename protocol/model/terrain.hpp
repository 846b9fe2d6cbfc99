#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace trochoid {

/// Height raster in the world frame (x east, z south, y up; lattice unit 2^-10 m).
///
/// Sample [row][column] lies at x = origin_x + column * 2^spacing_log2, z = origin_z + row * 2^spacing_log2, and stands
/// heights[row * columns + column] * 2^height_step_log2 lattice units above sea level.
/// `terrain_fault` tells which of the stated ranges a grid breaks; every function below expects a grid without fault.
struct TerrainGrid {
    /// Lattice units of sample [0][0]; multiples of the spacing, |origin| and far edge <= 2^35.
    int64_t origin_x = 0;
    int64_t origin_z = 0;
    /// Sample spacing = 2^spacing_log2 lattice units, 0..20 (15 = 32 m).
    uint32_t spacing_log2 = 15;
    /// Samples along x and along z, each 2..16385; row-major, z grows with the row (southwards).
    uint32_t columns = 0;
    uint32_t rows = 0;
    /// One count = 2^height_step_log2 lattice units, 0..10 (5 = 1/32 m, reaching +-1024 m).
    int32_t height_step_log2 = 5;
    /// Counts, positive up, sea level 0; columns * rows of them.
    std::vector<int16_t> heights;
    /// Bed level far outside the grid, lattice units, -2^24..-1 (see height_at).
    int32_t open_sea_depth = -(60 << 10);
    /// PROJ string of the map projection and the degrees (WGS 84) of x = z = 0.
    std::string projection;
    double origin_lon = 0.0;
    double origin_lat = 0.0;
    /// Free text: where the heights come from, and which part of them is synthetic.
    std::string provenance;

    bool operator==(const TerrainGrid&) const = default;
};

/// Cells along a tile's side; a tile has one sample more than that along each side.
inline constexpr uint32_t terrain_tile_cells = 64;
inline constexpr uint32_t terrain_tile_samples = terrain_tile_cells + 1;
/// Width of the belt around a grid in which the bed goes over into the open sea, in cells of the grid (2^6 = 64).
inline constexpr uint32_t open_sea_belt_cells_log2 = 6;

/// Place of a tile in the quadtree. Level 0 is the finest. Tile (x, z) of level L covers the cells
/// [x * 64 * 2^L, (x + 1) * 64 * 2^L) eastwards of the grid's origin, z alike southwards; its four children are
/// (2x, 2z) .. (2x + 1, 2z + 1) of level L - 1.
struct TerrainTileKey {
    uint8_t level = 0;
    int32_t x = 0;
    int32_t z = 0;

    bool operator==(const TerrainTileKey&) const = default;
};

/// A square of 65 x 65 samples, self-contained for the wire. Neighbours share their border samples, and every
/// sample of a coarser tile is one of the finest level's (plain decimation), so shared nodes agree at all levels.
struct TerrainTile {
    TerrainTileKey key;
    /// Lattice units of the tile's first sample.
    int64_t origin_x = 0;
    int64_t origin_z = 0;
    /// Sample spacing of this tile = 2^spacing_log2 lattice units: the grid's plus the level.
    uint32_t spacing_log2 = 0;
    /// As in TerrainGrid.
    int32_t height_step_log2 = 0;
    /// 65 * 65 counts, row-major as in TerrainGrid.
    std::vector<int16_t> heights;

    bool operator==(const TerrainTile&) const = default;
};

/// Null where the grid keeps all ranges stated at its members, else a sentence naming the first member that does not.
const char* terrain_fault(const TerrainGrid& grid);

/// Height of the bed or the land above sea level at a world position, in lattice units; |x|, |z| <= 2^36.
///
/// Inside the grid: bilinear between the four samples around, rounded half up. Outside, with e the height at the
/// nearest point of the grid's border and d the larger of the distances along x and z to it:
/// e + (open_sea_depth - e) * min(d, R) / R, rounded half up, where R = 2^(spacing_log2 + open_sea_belt_cells_log2).
/// So the height is continuous everywhere, and exactly open_sea_depth from R onwards. Integers only.
int32_t height_at(const TerrainGrid& grid, int64_t x, int64_t z);

/// Count at a lattice node of the grid (column and row may lie outside it: then height_at there, rounded half up to a
/// count and clamped to int16).
int16_t height_count_at(const TerrainGrid& grid, int64_t column, int64_t row);

/// Number of quadtree levels, at least 1; the coarsest (tile_levels - 1) covers the grid with one tile.
uint32_t tile_levels(const TerrainGrid& grid);

/// Keys of the level's tiles that touch the grid, row by row from north-west; empty from tile_levels on.
std::vector<TerrainTileKey> tiles_at_level(const TerrainGrid& grid, uint32_t level);

/// The tile; samples beyond the grid's last row or column come from height_count_at. Any key whose level is below
/// tile_levels gives a tile, also one that does not touch the grid.
TerrainTile make_tile(const TerrainGrid& grid, TerrainTileKey key);

/// 64-bit FNV-1a over the members' little-endian bytes in order of declaration (level as one byte); the same on
/// every machine.
uint64_t tile_hash(const TerrainTile& tile);

/// Largest vertical distance, in lattice units rounded up, between the tile drawn as triangles (either diagonal in each
/// cell) and the finest level's nodes inside it. 0 at level 0; never below that of a child, so it may steer a selection
/// by screen-space error.
int32_t tile_geometric_error(const TerrainGrid& grid, TerrainTileKey key);

}  // namespace trochoid
