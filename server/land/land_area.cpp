#include "server/land/land_area.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

/// Coarsest field there is (LandField).
constexpr uint8_t coarsest_step_log2 = 20;

LatticeRect grown(const LatticeRect& r, int64_t by) {
    return {{r.min.x - by, r.min.z - by}, {r.max.x + by, r.max.z + by}};
}

LandArea area_of(const LatticeRect& reach, uint8_t step_log2) {
    const BlockRange blocks = blocks_touching(reach, step_log2);
    LandArea area;
    area.step_log2 = step_log2;
    area.first = blocks.first;
    area.blocks_x = blocks.last.x - blocks.first.x + 1;
    area.blocks_z = blocks.last.z - blocks.first.z + 1;
    return area;
}

}  // namespace

LatticePoint LandArea::at(int32_t x, int32_t z) const {
    return {(int64_t{first.x} * block_cells + x) * (int64_t{1} << step_log2),
            (int64_t{first.z} * block_cells + z) * (int64_t{1} << step_log2)};
}

LatticeRect belt_bounds(const TerrainGrid& terrain) {
    const int64_t spacing = int64_t{1} << terrain.spacing_log2;
    const LatticeRect grid{{terrain.origin_x, terrain.origin_z},
                           {terrain.origin_x + (int64_t{terrain.columns} - 1) * spacing,
                            terrain.origin_z + (int64_t{terrain.rows} - 1) * spacing}};
    return grown(grid, spacing << open_sea_belt_cells_log2);
}

LandArea land_area(const WaveTrainBox& box, const TerrainGrid& terrain, const LandSettings& settings) {
    const LatticeRect belt = belt_bounds(terrain);
    const LatticeRect around = grown(belt, to_lattice(settings.run_out));
    const LatticeRect covered = bounds_of(box);
    const LatticeRect reach{{std::max(around.min.x, covered.min.x), std::max(around.min.z, covered.min.z)},
                            {std::min(around.max.x, covered.max.x), std::min(around.max.z, covered.max.z)}};
    if (reach.min.x > reach.max.x || reach.min.z > reach.max.z) return LandArea{};
    LandArea area = area_of(reach, settings.step_log2);
    while (area.nodes() > settings.nodes_max && area.step_log2 < coarsest_step_log2)
        area = area_of(reach, static_cast<uint8_t>(area.step_log2 + 1));
    const LatticePoint origin = area.at(0, 0);
    area.belt_min_x = to_metres(belt.min.x - origin.x);
    area.belt_min_z = to_metres(belt.min.z - origin.z);
    area.belt_max_x = to_metres(belt.max.x - origin.x);
    area.belt_max_z = to_metres(belt.max.z - origin.z);
    return area;
}

std::vector<float> node_depths(const LandArea& area, const WaveTrainBox& box, const TerrainGrid& terrain) {
    std::vector<float> depths;
    depths.reserve(area.nodes());
    for (int32_t z = 0; z < area.nodes_z(); ++z) {
        for (int32_t x = 0; x < area.nodes_x(); ++x) {
            const LatticePoint p = area.at(x, z);
            const BoxPosition place = box.length != 0 ? box_position(box, p) : BoxPosition{};
            if (place.in_reach && place.u < 0) {
                depths.push_back(deepest_depth);
                continue;
            }
            // At most 25 bits: exact in float32, and so is the division by 2^10.
            depths.push_back(static_cast<float>(-height_at(terrain, p.x, p.z)) / 1024.0F);
        }
    }
    return depths;
}

}  // namespace trochoid
