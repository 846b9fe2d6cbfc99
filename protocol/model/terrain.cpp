#include "protocol/model/terrain.hpp"

#include <algorithm>
#include <cstdlib>

#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"
#include "protocol/units/lattice.hpp"

namespace trochoid {
namespace {

constexpr uint32_t spacing_log2_max = 20;
constexpr int32_t height_step_log2_max = 10;
constexpr uint32_t side_samples_max = 16385;
constexpr int32_t open_sea_depth_min = -(1 << 24);
/// A grid of 2^14 cells needs levels 0..8, a belt beyond it never more than a few; above this a key is our bug.
constexpr uint32_t tile_levels_max = 16;

int64_t spacing_of(const TerrainGrid& grid) { return int64_t{1} << grid.spacing_log2; }

/// value * 2^-shift (shift may be negative), rounded half up.
int64_t shift_rounded(int64_t value, int32_t shift) {
    if (shift <= 0) return value * (int64_t{1} << -shift);
    return (value + (int64_t{1} << (shift - 1))) >> shift;
}

int64_t count_at(const TerrainGrid& grid, int64_t column, int64_t row) {
    return grid.heights[static_cast<std::size_t>(row * grid.columns + column)];
}

/// Bilinear height at an offset from the origin that lies inside the grid, in lattice units.
int64_t inside_height(const TerrainGrid& grid, int64_t dx, int64_t dz) {
    const int64_t n = spacing_of(grid);
    // The last column and row belong to the cell before them, at its far side.
    const int64_t column = std::min<int64_t>(dx >> grid.spacing_log2, int64_t{grid.columns} - 2);
    const int64_t row = std::min<int64_t>(dz >> grid.spacing_log2, int64_t{grid.rows} - 2);
    const int64_t fx = dx - column * n;
    const int64_t fz = dz - row * n;
    // 16 + 20 + 20 bits at most.
    const int64_t north = count_at(grid, column, row) * (n - fx) + count_at(grid, column + 1, row) * fx;
    const int64_t south =
        count_at(grid, column, row + 1) * (n - fx) + count_at(grid, column + 1, row + 1) * fx;
    const int64_t sum = north * (n - fz) + south * fz;
    return shift_rounded(sum, static_cast<int32_t>(2 * grid.spacing_log2) - grid.height_step_log2);
}

bool on_grid_of_spacing(const TerrainGrid& grid, int64_t position) {
    return (position & (spacing_of(grid) - 1)) == 0;
}

bool inside_world_bounds(const TerrainGrid& grid) {
    const int64_t width = (int64_t{grid.columns} - 1) * spacing_of(grid);
    const int64_t depth = (int64_t{grid.rows} - 1) * spacing_of(grid);
    // The origin is tested alone first, so that the far corner cannot overflow.
    const LatticePoint origin{grid.origin_x, grid.origin_z};
    return inside_world(origin) && inside_world({grid.origin_x + width, grid.origin_z + depth});
}

/// Linear interpolation inside a tile's cell of n x n finest cells at (i, j), times n: once with the diagonal from
/// north-west to south-east, once with the other.
struct CellHeights {
    int64_t nw, ne, sw, se;
};

int64_t on_falling_diagonal(const CellHeights& h, int64_t n, int64_t i, int64_t j) {
    if (i >= j) return h.nw * (n - i) + h.ne * (i - j) + h.se * j;
    return h.nw * (n - j) + h.sw * (j - i) + h.se * i;
}

int64_t on_rising_diagonal(const CellHeights& h, int64_t n, int64_t i, int64_t j) {
    if (i + j <= n) return h.nw * (n - i - j) + h.ne * i + h.sw * j;
    return h.se * (i + j - n) + h.ne * (n - j) + h.sw * (n - i);
}

/// Largest distance between a cell's triangles and the finest nodes in it, in counts times n.
int64_t cell_error(const TerrainGrid& grid, int64_t column, int64_t row, int64_t n) {
    const CellHeights h{height_count_at(grid, column, row), height_count_at(grid, column + n, row),
                        height_count_at(grid, column, row + n), height_count_at(grid, column + n, row + n)};
    int64_t worst = 0;
    for (int64_t j = 0; j <= n; ++j) {
        for (int64_t i = 0; i <= n; ++i) {
            const int64_t exact = n * height_count_at(grid, column + i, row + j);
            worst = std::max({worst, std::abs(on_falling_diagonal(h, n, i, j) - exact),
                              std::abs(on_rising_diagonal(h, n, i, j) - exact)});
        }
    }
    return worst;
}

}  // namespace

const char* terrain_fault(const TerrainGrid& grid) {
    if (grid.spacing_log2 > spacing_log2_max)
        return "the sample spacing is above 1024 m (2^20 lattice units)";
    if (grid.height_step_log2 < 0 || grid.height_step_log2 > height_step_log2_max)
        return "the height step is outside 2^0..2^10 lattice units";
    if (grid.columns < 2 || grid.rows < 2) return "the grid has fewer than 2 columns or rows";
    if (grid.columns > side_samples_max || grid.rows > side_samples_max)
        return "the grid has more than 16385 columns or rows";
    if (grid.heights.size() != std::size_t{grid.columns} * grid.rows)
        return "the number of heights is not columns times rows";
    if (!on_grid_of_spacing(grid, grid.origin_x) || !on_grid_of_spacing(grid, grid.origin_z))
        return "the origin is not a multiple of the sample spacing";
    if (!inside_world_bounds(grid)) return "the grid reaches beyond the world's bounds (2^35 lattice units)";
    if (grid.open_sea_depth >= 0 || grid.open_sea_depth < open_sea_depth_min)
        return "the open-sea depth is not between 2^24 lattice units below sea level and the surface";
    if (!(grid.origin_lon >= -180.0 && grid.origin_lon <= 180.0 && grid.origin_lat >= -90.0 &&
          grid.origin_lat <= 90.0))
        return "the origin's longitude or latitude is outside -180..180 or -90..90 degrees";
    return nullptr;
}

int32_t height_at(const TerrainGrid& grid, int64_t x, int64_t z) {
    const int64_t width = (int64_t{grid.columns} - 1) << grid.spacing_log2;
    const int64_t depth = (int64_t{grid.rows} - 1) << grid.spacing_log2;
    const int64_t dx = x - grid.origin_x;
    const int64_t dz = z - grid.origin_z;
    const int64_t nearest_dx = std::clamp<int64_t>(dx, 0, width);
    const int64_t nearest_dz = std::clamp<int64_t>(dz, 0, depth);
    const int64_t edge = inside_height(grid, nearest_dx, nearest_dz);
    const int64_t distance = std::max(std::abs(dx - nearest_dx), std::abs(dz - nearest_dz));
    if (distance == 0) return static_cast<int32_t>(edge);
    const uint32_t belt_log2 = grid.spacing_log2 + open_sea_belt_cells_log2;
    const int64_t inside_belt = std::min(distance, int64_t{1} << belt_log2);
    // 27 + 26 bits at most.
    const int64_t blend = (grid.open_sea_depth - edge) * inside_belt;
    return static_cast<int32_t>(edge + shift_rounded(blend, static_cast<int32_t>(belt_log2)));
}

int16_t height_count_at(const TerrainGrid& grid, int64_t column, int64_t row) {
    if (column >= 0 && row >= 0 && column < grid.columns && row < grid.rows)
        return static_cast<int16_t>(count_at(grid, column, row));
    const int64_t n = spacing_of(grid);
    const int64_t units = height_at(grid, grid.origin_x + column * n, grid.origin_z + row * n);
    return static_cast<int16_t>(
        std::clamp<int64_t>(shift_rounded(units, grid.height_step_log2), INT16_MIN, INT16_MAX));
}

uint32_t tile_levels(const TerrainGrid& grid) {
    const uint32_t cells = std::max(grid.columns, grid.rows) - 1;
    uint32_t levels = 1;
    while ((terrain_tile_cells << (levels - 1)) < cells) ++levels;
    return levels;
}

std::vector<TerrainTileKey> tiles_at_level(const TerrainGrid& grid, uint32_t level) {
    std::vector<TerrainTileKey> keys;
    if (level >= tile_levels(grid)) return keys;
    const uint32_t cells = terrain_tile_cells << level;
    const uint32_t across = (grid.columns - 2) / cells + 1;
    const uint32_t down = (grid.rows - 2) / cells + 1;
    keys.reserve(std::size_t{across} * down);
    for (uint32_t z = 0; z < down; ++z)
        for (uint32_t x = 0; x < across; ++x)
            keys.push_back({static_cast<uint8_t>(level), static_cast<int32_t>(x), static_cast<int32_t>(z)});
    return keys;
}

TerrainTile make_tile(const TerrainGrid& grid, TerrainTileKey key) {
    TROCHOID_ASSERT(key.level < tile_levels_max, "tile level {}", key.level);
    const int64_t step = int64_t{1} << key.level;
    const int64_t first_column = key.x * step * terrain_tile_cells;
    const int64_t first_row = key.z * step * terrain_tile_cells;
    TerrainTile tile;
    tile.key = key;
    tile.origin_x = grid.origin_x + first_column * spacing_of(grid);
    tile.origin_z = grid.origin_z + first_row * spacing_of(grid);
    tile.spacing_log2 = grid.spacing_log2 + key.level;
    tile.height_step_log2 = grid.height_step_log2;
    tile.heights.reserve(std::size_t{terrain_tile_samples} * terrain_tile_samples);
    for (int64_t row = 0; row < terrain_tile_samples; ++row)
        for (int64_t column = 0; column < terrain_tile_samples; ++column)
            tile.heights.push_back(
                height_count_at(grid, first_column + column * step, first_row + row * step));
    return tile;
}

uint64_t tile_hash(const TerrainTile& tile) {
    Hash64 hash;
    hash.u8(tile.key.level).i32(tile.key.x).i32(tile.key.z);
    hash.i64(tile.origin_x).i64(tile.origin_z).u32(tile.spacing_log2).i32(tile.height_step_log2);
    for (const int16_t height : tile.heights) hash.i16(height);
    return hash.value();
}

int32_t tile_geometric_error(const TerrainGrid& grid, TerrainTileKey key) {
    TROCHOID_ASSERT(key.level < tile_levels_max, "tile level {}", key.level);
    if (key.level == 0) return 0;
    const int64_t n = int64_t{1} << key.level;
    int64_t worst = 0;
    for (int64_t cell = 0; cell < int64_t{terrain_tile_cells} * terrain_tile_cells; ++cell) {
        const int64_t column = (key.x * int64_t{terrain_tile_cells} + cell % terrain_tile_cells) * n;
        const int64_t row = (key.z * int64_t{terrain_tile_cells} + cell / terrain_tile_cells) * n;
        worst = std::max(worst, cell_error(grid, column, row, n));
    }
    const int64_t units = ((worst << grid.height_step_log2) + n - 1) >> key.level;
    int32_t error = static_cast<int32_t>(units);
    for (int32_t child = 0; child < 4; ++child) {
        const TerrainTileKey below{static_cast<uint8_t>(key.level - 1), 2 * key.x + child % 2,
                                   2 * key.z + child / 2};
        error = std::max(error, tile_geometric_error(grid, below));
    }
    return error;
}

}  // namespace trochoid
