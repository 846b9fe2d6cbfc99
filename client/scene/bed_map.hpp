#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "client/scene/camera.hpp"
#include "client/scene/scene_input.hpp"

namespace trochoid {

/// Height of the bed over the whole terrain on one grid, metres above still water, made of the tiles known so far: colours
/// shallow water and places the surf.
struct BedMap {
    uint32_t columns = 1;
    uint32_t rows = 1;
    std::vector<float> heights{-60.0F};
    int64_t origin_x = 0;  ///< lattice units of sample [0][0]
    int64_t origin_z = 0;
    double spacing_m = 1;       ///< between samples
    float open_sea_m = -60.0F;  ///< far outside
    float belt_m = 1.0F;        ///< outside the raster, over which the bed falls from its edge to that
    bool operator==(const BedMap&) const = default;
};

/// Most samples along a side; larger terrains are taken at every second, fourth, … sample.
inline constexpr uint32_t bed_map_side = 1024;

/// Open sea where no tile is known. Finer tiles win over coarser ones.
BedMap make_bed_map(const TerrainExtent& extent,
                    const std::vector<std::shared_ptr<const TerrainTile>>& tiles);

/// (scale, scale, offset, offset): texture coordinates = metres from the anchor * scale + offset.
glm::vec4 bed_map_transform(const BedMap& map, const CameraFrame& frame);

}  // namespace trochoid
