#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "client/scene/frustum.hpp"
#include "protocol/model/terrain.hpp"

namespace trochoid {

/// A vertex of a terrain tile: 8 bytes. Its place follows from its number in the tile.
struct TerrainVertex {
    int16_t height = 0;  ///< counts of 2^height_step_log2 lattice units
    int16_t skirt =
        0;  ///< 1: hangs down below the tile's border, hiding what neighbours of another level leave open
    int8_t nx = 0;  ///< unit normal, 127 = 1
    int8_t ny = 127;
    int8_t nz = 0;
    int8_t pad = 0;
};
/// Vertices of a tile: 65 x 65, row by row, then 4 x 65 for the skirts (north, south, west, east).
inline constexpr uint32_t terrain_vertices =
    terrain_tile_samples * terrain_tile_samples + 4 * terrain_tile_samples;
std::vector<TerrainVertex> terrain_vertices_of(const TerrainTile& tile);

/// Steps between the samples that a triangle list uses: 1, 2, 4, 8.
inline constexpr uint32_t terrain_strides = 4;
/// Indices of one quadrant (0 north-west, 1 north-east, 2 south-west, 3 south-east) at one stride, with its skirts.
std::vector<uint16_t> terrain_indices(uint32_t quadrant, uint32_t stride);

/// A quadrant of a tile to draw.
struct TerrainDraw {
    std::shared_ptr<const TerrainTile> tile;
    uint32_t quadrant = 0;
    uint32_t stride_log2 = 0;
};

struct TerrainSelection {
    std::vector<TerrainDraw> draws;
    uint32_t triangles = 0;
};

/// Picks what to draw: the finest tiles where they are near enough to matter, a coarser one's quadrant elsewhere; never both
/// over one place. Quadrants that lie wholly deeper than 12 m are hidden by water and left out.
/// `error_px` is the height error that a coarser choice may show, in pixels.
TerrainSelection select_terrain(const std::vector<std::shared_ptr<const TerrainTile>>& tiles,
                                const CameraFrame& frame, const FrustumPlanes& planes,
                                float radians_per_pixel, float error_px);

}  // namespace trochoid
