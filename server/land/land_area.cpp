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

void take_corners(LandArea& area, const WaveTrainBox& box, LatticePoint origin) {
    const double ux = static_cast<double>(box.ux) * 0x1p-30;
    const double uz = static_cast<double>(box.uz) * 0x1p-30;
    size_t i = 0;
    for (const int64_t u : {int64_t{0}, box.length}) {
        for (const int64_t v : {int64_t{0}, box.width}) {
            const double x = static_cast<double>(box.origin.x - origin.x) + static_cast<double>(u) * ux -
                             static_cast<double>(v) * uz;
            const double z = static_cast<double>(box.origin.z - origin.z) + static_cast<double>(u) * uz +
                             static_cast<double>(v) * ux;
            area.corners[i++] = x / static_cast<double>(int64_t{1} << area.step_log2);
            area.corners[i++] = z / static_cast<double>(int64_t{1} << area.step_log2);
        }
    }
    area.cornered = true;
}

/// Depths of one row of nodes; where nodes are samples of the terrain they are read straight from it.
void fill_depths(float* row, const LandArea& area, int32_t z, const TerrainGrid& terrain, float raised) {
    const int64_t spacing = int64_t{1} << terrain.spacing_log2;
    const LatticePoint first = area.at(0, z);
    const int64_t step = int64_t{1} << area.step_log2;
    const int64_t far_x = terrain.origin_x + (int64_t{terrain.columns} - 1) * spacing;
    const int64_t far_z = terrain.origin_z + (int64_t{terrain.rows} - 1) * spacing;
    const bool on_samples =
        area.step_log2 >= terrain.spacing_log2 && first.z >= terrain.origin_z && first.z <= far_z;
    const int16_t* const samples =
        on_samples ? terrain.heights.data() +
                         ((first.z - terrain.origin_z) >> terrain.spacing_log2) * int64_t{terrain.columns}
                   : nullptr;
    // Counts to metres: exact, as the division by 2^10 below is (at most 25 bits).
    const float per_count = static_cast<float>(int32_t{1} << terrain.height_step_log2) / 1024.0F;
    for (int32_t i = 0; i < area.nodes_x(); ++i) {
        const int64_t x = first.x + i * step;
        if (on_samples && x >= terrain.origin_x && x <= far_x) {
            const int16_t count = samples[(x - terrain.origin_x) >> terrain.spacing_log2];
            row[i] = static_cast<float>(-int32_t{count}) * per_count + raised;
        } else {
            row[i] = static_cast<float>(-height_at(terrain, x, first.z)) / 1024.0F + raised;
        }
    }
}

/// Nodes behind the box's rear side (u < 0) are open water.
void clear_behind(float* row, const LandArea& area, int32_t z, const WaveTrainBox& box) {
    constexpr int64_t reach = int64_t{1} << 31;
    const LatticePoint first = area.at(0, z);
    const int64_t step = int64_t{1} << area.step_log2;
    const int64_t dz = first.z - box.origin.z;
    if (dz > reach || dz < -reach) return;
    for (int32_t i = 0; i < area.nodes_x(); ++i) {
        const int64_t dx = first.x + i * step - box.origin.x;
        if (dx <= reach && dx >= -reach && dx * box.ux + dz * box.uz < 0) row[i] = deepest_depth;
    }
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
    const bool moving = !box.course.empty();
    const LatticeRect belt = belt_bounds(terrain);
    const LatticeRect around = grown(belt, to_lattice(settings.run_out));
    const LatticeRect covered = moving ? around : bounds_of(box);
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
    if (!moving && box.length != 0 && box.width != 0) take_corners(area, box, origin);
    return area;
}

std::vector<float> node_depths(const LandArea& area, const WaveTrainBox& box, const TerrainGrid& terrain,
                               double run_up) {
    std::vector<float> depths(area.nodes());
    const auto raised = static_cast<float>(run_up);
    const bool with_rear = box.length != 0 && box.course.empty();
    for (int32_t z = 0; z < area.nodes_z(); ++z) {
        float* const row = depths.data() + static_cast<size_t>(z) * static_cast<size_t>(area.nodes_x());
        fill_depths(row, area, z, terrain, raised);
        if (with_rear) clear_behind(row, area, z, box);
    }
    return depths;
}

}  // namespace trochoid
