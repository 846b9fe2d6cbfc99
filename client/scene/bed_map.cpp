#include "client/scene/bed_map.hpp"

#include <algorithm>
#include <cmath>

namespace trochoid {

namespace {

/// Copies a tile's samples to the map's nodes that they cover; a coarse tile fills the nodes between by interpolation.
void paint(BedMap& map, const TerrainTile& tile) {
    const double spacing = std::ldexp(1.0, static_cast<int>(tile.spacing_log2) - 10);
    const double metres = std::ldexp(1.0, tile.height_step_log2 - 10);
    const double first_column = to_metres(tile.origin_x - map.origin_x) / map.spacing_m;
    const double first_row = to_metres(tile.origin_z - map.origin_z) / map.spacing_m;
    const double nodes = spacing * terrain_tile_cells / map.spacing_m;
    const auto clip = [](double v, uint32_t limit) {
        return static_cast<uint32_t>(std::clamp(v, 0.0, static_cast<double>(limit)));
    };
    for (uint32_t row = clip(std::ceil(first_row), map.rows);
         row < clip(std::floor(first_row + nodes) + 1, map.rows); ++row)
        for (uint32_t column = clip(std::ceil(first_column), map.columns);
             column < clip(std::floor(first_column + nodes) + 1, map.columns); ++column) {
            const double x = std::clamp((column - first_column) * map.spacing_m / spacing, 0.0,
                                        static_cast<double>(terrain_tile_cells));
            const double z = std::clamp((row - first_row) * map.spacing_m / spacing, 0.0,
                                        static_cast<double>(terrain_tile_cells));
            const auto i = static_cast<uint32_t>(std::min(x, terrain_tile_cells - 1.0));
            const auto j = static_cast<uint32_t>(std::min(z, terrain_tile_cells - 1.0));
            const auto at = [&](uint32_t c, uint32_t r) {
                return static_cast<double>(tile.heights[r * terrain_tile_samples + c]);
            };
            const double north = at(i, j) + (at(i + 1, j) - at(i, j)) * (x - i);
            const double south = at(i, j + 1) + (at(i + 1, j + 1) - at(i, j + 1)) * (x - i);
            map.heights[row * map.columns + column] =
                static_cast<float>((north + (south - north) * (z - j)) * metres);
        }
}

}  // namespace

BedMap make_bed_map(const TerrainExtent& extent,
                    const std::vector<std::shared_ptr<const TerrainTile>>& tiles) {
    BedMap map;
    if (extent.columns < 2 || extent.rows < 2) return map;
    uint32_t step = 1;
    while (std::max(extent.columns, extent.rows) / step > bed_map_side) step *= 2;
    map.columns = (extent.columns - 1) / step + 1;
    map.rows = (extent.rows - 1) / step + 1;
    map.origin_x = extent.origin_x;
    map.origin_z = extent.origin_z;
    map.spacing_m = std::ldexp(1.0, static_cast<int>(extent.spacing_log2) - 10) * step;
    map.open_sea_m = static_cast<float>(to_metres(extent.open_sea_depth));
    map.belt_m =
        static_cast<float>(to_metres(int64_t{1} << (extent.spacing_log2 + open_sea_belt_cells_log2)));
    map.heights.assign(size_t{map.columns} * map.rows, map.open_sea_m);
    std::vector<const TerrainTile*> coarse_first;
    coarse_first.reserve(tiles.size());
    for (const auto& tile : tiles) coarse_first.push_back(tile.get());
    std::stable_sort(coarse_first.begin(), coarse_first.end(),
                     [](const auto* a, const auto* b) { return a->key.level > b->key.level; });
    for (const TerrainTile* tile : coarse_first) paint(map, *tile);
    return map;
}

glm::vec4 bed_map_transform(const BedMap& map, const CameraFrame& frame) {
    const double width = map.spacing_m * map.columns;
    const double depth = map.spacing_m * map.rows;
    const auto offset = [](double metres, double size, uint32_t samples) {
        return static_cast<float>(metres / size + 0.5 / samples);
    };
    return {static_cast<float>(1.0 / width), static_cast<float>(1.0 / depth),
            offset(to_metres(frame.anchor.x - map.origin_x), width, map.columns),
            offset(to_metres(frame.anchor.z - map.origin_z), depth, map.rows)};
}

}  // namespace trochoid
