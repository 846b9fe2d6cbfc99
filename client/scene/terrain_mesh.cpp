#include "client/scene/terrain_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <tuple>

namespace trochoid {

namespace {

constexpr uint32_t last = terrain_tile_samples - 1;
constexpr double hidden_depth_m = 12.0;

double metres_per_count(const TerrainTile& tile) { return std::ldexp(1.0, tile.height_step_log2 - 10); }
double spacing_m(const TerrainTile& tile) {
    return std::ldexp(1.0, static_cast<int>(tile.spacing_log2) - 10);
}

int16_t height_of(const TerrainTile& tile, uint32_t column, uint32_t row) {
    return tile.heights[row * terrain_tile_samples + column];
}

TerrainVertex vertex_of(const TerrainTile& tile, uint32_t column, uint32_t row) {
    const uint32_t west = column == 0 ? 0 : column - 1;
    const uint32_t east = std::min(column + 1, last);
    const uint32_t north = row == 0 ? 0 : row - 1;
    const uint32_t south = std::min(row + 1, last);
    const double scale = metres_per_count(tile) / spacing_m(tile);
    const double slope_x = (height_of(tile, east, row) - height_of(tile, west, row)) * scale / (east - west);
    const double slope_z =
        (height_of(tile, column, south) - height_of(tile, column, north)) * scale / (south - north);
    const glm::dvec3 normal = glm::normalize(glm::dvec3(-slope_x, 1.0, -slope_z)) * 127.0;
    const auto byte = [](double v) { return static_cast<int8_t>(std::lround(v)); };
    return {height_of(tile, column, row), 0, byte(normal.x), byte(normal.y), byte(normal.z), 0};
}

uint16_t number_of(uint32_t column, uint32_t row) {
    return static_cast<uint16_t>(row * terrain_tile_samples + column);
}

/// Number of the vertex that hangs below a border's vertex: borders in the order north, south, west, east.
uint16_t skirt_of(uint32_t border, uint32_t along) {
    return static_cast<uint16_t>(terrain_tile_samples * terrain_tile_samples + border * terrain_tile_samples +
                                 along);
}

struct Border {
    uint32_t number;
    bool along_x;
    uint32_t fixed;
    bool outward_first;  // winding
};

void append_skirt(std::vector<uint16_t>& out, const Border& border, uint32_t first, uint32_t stride) {
    for (uint32_t i = first; i < first + terrain_tile_cells / 2; i += stride) {
        const auto top = [&](uint32_t along) {
            return border.along_x ? number_of(along, border.fixed) : number_of(border.fixed, along);
        };
        const uint16_t a = top(i);
        const uint16_t b = top(i + stride);
        const uint16_t c = skirt_of(border.number, i);
        const uint16_t d = skirt_of(border.number, i + stride);
        if (border.outward_first)
            out.insert(out.end(), {a, b, c, b, d, c});
        else
            out.insert(out.end(), {a, c, b, b, c, d});
    }
}

using TileIndex = std::map<std::tuple<uint8_t, int32_t, int32_t>, std::shared_ptr<const TerrainTile>>;

struct Selecting {
    const TileIndex& index;
    const CameraFrame& frame;
    const FrustumPlanes& planes;
    float radians_per_pixel;
    float error_px;
    TerrainSelection& out;
};

/// Lowest and highest sample of a quadrant, metres.
std::pair<float, float> span_of(const TerrainTile& tile, uint32_t quadrant) {
    const uint32_t half = terrain_tile_cells / 2;
    const uint32_t first_column = (quadrant & 1U) * half;
    const uint32_t first_row = (quadrant >> 1U) * half;
    int16_t low = INT16_MAX;
    int16_t high = INT16_MIN;
    for (uint32_t row = first_row; row <= first_row + half; ++row)
        for (uint32_t column = first_column; column <= first_column + half; ++column) {
            low = std::min(low, height_of(tile, column, row));
            high = std::max(high, height_of(tile, column, row));
        }
    const double metres = metres_per_count(tile);
    return {static_cast<float>(low * metres), static_cast<float>(high * metres)};
}

Bounds quadrant_bounds(const CameraFrame& frame, const TerrainTile& tile, uint32_t quadrant, float low,
                       float high) {
    const int64_t side = int64_t{terrain_tile_cells / 2} << tile.spacing_log2;
    const LatticePoint corner{tile.origin_x + ((quadrant & 1U) != 0 ? side : 0),
                              tile.origin_z + ((quadrant >> 1U) != 0 ? side : 0)};
    Bounds bounds = bounds_of_square(frame, corner, side, 0.0F, 0.0F);
    bounds.low.y += std::min(low, 0.0F) - 10.0F;
    bounds.high.y += std::max(high, 0.0F);
    return bounds;
}

float distance_to(const Bounds& bounds) {
    const glm::vec3 nearest(std::clamp(0.0F, bounds.low.x, bounds.high.x),
                            std::clamp(0.0F, bounds.low.y, bounds.high.y),
                            std::clamp(0.0F, bounds.low.z, bounds.high.z));
    return glm::length(nearest);
}

void select(const Selecting& s, const std::shared_ptr<const TerrainTile>& tile) {
    for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) {
        const auto [low, high] = span_of(*tile, quadrant);
        if (high < static_cast<float>(-hidden_depth_m)) continue;
        const Bounds bounds = quadrant_bounds(s.frame, *tile, quadrant, low, high);
        if (!may_see(s.planes, bounds)) continue;
        const float distance = std::max(distance_to(bounds), 1.0F);
        // A step between samples hides relief of about an eighth of its length; one pixel of it may be missed.
        const auto pixels = static_cast<float>(spacing_m(*tile)) / 8.0F / (distance * s.radians_per_pixel);
        const TerrainTileKey& key = tile->key;
        if (key.level > 0 && pixels > s.error_px) {
            const auto child = s.index.find({static_cast<uint8_t>(key.level - 1),
                                             2 * key.x + static_cast<int32_t>(quadrant & 1U),
                                             2 * key.z + static_cast<int32_t>(quadrant >> 1U)});
            if (child != s.index.end()) {
                select(s, child->second);
                continue;
            }
        }
        uint32_t stride_log2 = 0;
        while (stride_log2 + 1 < terrain_strides &&
               pixels * static_cast<float>(2U << stride_log2) < s.error_px)
            ++stride_log2;
        s.out.draws.push_back({tile, quadrant, stride_log2});
        const uint32_t cells = (terrain_tile_cells / 2) >> stride_log2;
        s.out.triangles += 2 * cells * cells + 4 * cells;
    }
}

}  // namespace

std::vector<TerrainVertex> terrain_vertices_of(const TerrainTile& tile) {
    std::vector<TerrainVertex> out;
    out.reserve(terrain_vertices);
    for (uint32_t row = 0; row < terrain_tile_samples; ++row)
        for (uint32_t column = 0; column < terrain_tile_samples; ++column)
            out.push_back(vertex_of(tile, column, row));
    const auto hang = [&](uint32_t column, uint32_t row) {
        TerrainVertex vertex = out[number_of(column, row)];
        vertex.skirt = 1;
        out.push_back(vertex);
    };
    for (uint32_t i = 0; i < terrain_tile_samples; ++i) hang(i, 0);
    for (uint32_t i = 0; i < terrain_tile_samples; ++i) hang(i, last);
    for (uint32_t i = 0; i < terrain_tile_samples; ++i) hang(0, i);
    for (uint32_t i = 0; i < terrain_tile_samples; ++i) hang(last, i);
    return out;
}

std::vector<uint16_t> terrain_indices(uint32_t quadrant, uint32_t stride) {
    constexpr uint32_t half = terrain_tile_cells / 2;
    const uint32_t first_column = (quadrant & 1U) * half;
    const uint32_t first_row = (quadrant >> 1U) * half;
    std::vector<uint16_t> out;
    for (uint32_t row = first_row; row < first_row + half; row += stride)
        for (uint32_t column = first_column; column < first_column + half; column += stride) {
            const uint16_t nw = number_of(column, row);
            const uint16_t ne = number_of(column + stride, row);
            const uint16_t sw = number_of(column, row + stride);
            const uint16_t se = number_of(column + stride, row + stride);
            out.insert(out.end(), {nw, sw, se, nw, se, ne});
        }
    if (first_row == 0) append_skirt(out, {0, true, 0, true}, first_column, stride);
    if (first_row != 0) append_skirt(out, {1, true, last, false}, first_column, stride);
    if (first_column == 0) append_skirt(out, {2, false, 0, false}, first_row, stride);
    if (first_column != 0) append_skirt(out, {3, false, last, true}, first_row, stride);
    return out;
}

TerrainSelection select_terrain(const std::vector<std::shared_ptr<const TerrainTile>>& tiles,
                                const CameraFrame& frame, const FrustumPlanes& planes,
                                float radians_per_pixel, float error_px) {
    TileIndex index;
    for (const auto& tile : tiles) index[{tile->key.level, tile->key.x, tile->key.z}] = tile;
    TerrainSelection out;
    const Selecting selecting{index, frame, planes, radians_per_pixel, error_px, out};
    for (const auto& [place, tile] : index) {
        // Roots: tiles that no known coarser one covers.
        bool covered = false;
        for (int up = 1; up <= 16 && !covered; ++up) {
            const auto level = static_cast<uint8_t>(tile->key.level + up);
            covered = index.contains({level, tile->key.x >> up, tile->key.z >> up});
        }
        if (!covered) select(selecting, tile);
    }
    return out;
}

}  // namespace trochoid
