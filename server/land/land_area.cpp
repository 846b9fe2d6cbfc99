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

/// Smallest i >= 0 with first + i * step >= limit, at most `count`.
int32_t nodes_before(int64_t first, int64_t step, int64_t limit, int32_t count) {
    if (limit <= first) return 0;
    return static_cast<int32_t>(std::min<int64_t>((limit - first + step - 1) / step, count));
}

void depths_of_samples(const int16_t* samples, size_t stride, size_t count, float per_count, float raised,
                       float* depths) {
    if (stride == 1) {
        for (size_t i = 0; i < count; ++i)
            depths[i] = static_cast<float>(-int32_t{samples[i]}) * per_count + raised;
        return;
    }
    for (size_t i = 0; i < count; ++i)
        depths[i] = static_cast<float>(-int32_t{samples[i * stride]}) * per_count + raised;
}

/// Depths of one row of nodes; where nodes are samples of the terrain they are read straight from it.
void fill_depths(float* row, const LandArea& area, int32_t z, const TerrainGrid& terrain, float raised) {
    const int64_t spacing = int64_t{1} << terrain.spacing_log2;
    const LatticePoint first = area.at(0, z);
    const int64_t step = int64_t{1} << area.step_log2;
    const int64_t far_x = terrain.origin_x + (int64_t{terrain.columns} - 1) * spacing;
    const int64_t far_z = terrain.origin_z + (int64_t{terrain.rows} - 1) * spacing;
    // Nodes [from, to) are samples.
    int32_t from = 0;
    int32_t to = 0;
    if (area.step_log2 >= terrain.spacing_log2 && first.z >= terrain.origin_z && first.z <= far_z) {
        from = nodes_before(first.x, step, terrain.origin_x, area.nodes_x());
        to = std::max(from, nodes_before(first.x, step, far_x + 1, area.nodes_x()));
    }
    const auto fill = [&](int32_t i, int32_t end) {
        for (; i < end; ++i)
            row[i] = static_cast<float>(-height_at(terrain, first.x + i * step, first.z)) / 1024.0F + raised;
    };
    fill(0, from);
    if (from < to) {
        const int64_t sample_row = (first.z - terrain.origin_z) >> terrain.spacing_log2;
        const int64_t column = (first.x + from * step - terrain.origin_x) >> terrain.spacing_log2;
        // Counts to metres: exact, as the division by 2^10 is (at most 25 bits).
        const float per_count = static_cast<float>(int32_t{1} << terrain.height_step_log2) / 1024.0F;
        depths_of_samples(terrain.heights.data() + sample_row * int64_t{terrain.columns} + column,
                          size_t{1} << (area.step_log2 - terrain.spacing_log2),
                          static_cast<size_t>(to - from), per_count, raised, row + from);
    }
    fill(to, area.nodes_x());
}

/// Nodes behind the box's rear side (u < 0) are open water.
void clear_behind(float* row, const LandArea& area, int32_t z, const WaveTrainBox& box) {
    constexpr int64_t reach = int64_t{1} << 31;
    const LatticePoint first = area.at(0, z);
    const int64_t step = int64_t{1} << area.step_log2;
    const int64_t dz = first.z - box.origin.z;
    if (dz > reach || dz < -reach) return;
    const int64_t first_dx = first.x - box.origin.x;
    const int32_t from = nodes_before(first_dx, step, -reach, area.nodes_x());
    const int32_t to = nodes_before(first_dx, step, reach + 1, area.nodes_x());
    const auto behind = [&](int32_t i) { return (first_dx + i * step) * box.ux + dz * box.uz < 0; };
    // u climbs or falls all along the row: what is behind lies at one of its ends.
    int32_t least = from;
    int32_t most = to;
    const bool rear_first = box.ux > 0;
    while (least < most) {
        const int32_t middle = least + (most - least) / 2;
        if (behind(middle) == rear_first)
            least = middle + 1;
        else
            most = middle;
    }
    if (rear_first)
        std::fill(row + from, row + least, deepest_depth);
    else if (from < to)
        std::fill(row + least, row + to, deepest_depth);
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
