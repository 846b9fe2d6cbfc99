#include "server/land/node_field.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

constexpr int32_t negligible_shift = 1 << 6;
constexpr int32_t negligible_gain = 1 << 4;

/// Nearest integer, halves up, for |value| < 2^31.
int32_t nearest(double value) {
    const double raised = value + 0.5;
    const auto whole = static_cast<int32_t>(raised);
    return static_cast<double>(whole) > raised ? whole - 1 : whole;
}

uint16_t node_gain(double gain) {
    const int32_t rounded = std::clamp(nearest(gain * 32768.0), 0, 65535);
    const int32_t off = rounded - unit_node_gain;
    return static_cast<uint16_t>(off <= negligible_gain && off >= -negligible_gain ? unit_node_gain
                                                                                   : rounded);
}

int32_t node_shift(double turns) {
    const int32_t rounded = nearest(turns * 65536.0);
    return rounded < negligible_shift && rounded > -negligible_shift ? 0 : rounded;
}

/// 1 on the terrain and its belt, falling smoothly to 0 over the run-out around them. x and z in metres from node [0][0].
double presence(const LandArea& area, double x, double z, double run_out) {
    const double beyond_x = std::max(std::max(area.belt_min_x - x, x - area.belt_max_x), 0.0);
    const double beyond_z = std::max(std::max(area.belt_min_z - z, z - area.belt_max_z), 0.0);
    const double beyond = std::max(beyond_x, beyond_z) / run_out;
    if (beyond >= 1.0) return 0.0;
    return 1.0 - beyond * beyond * (3.0 - 2.0 * beyond);
}

/// Whether a block's square can touch the box (conservatively, by its circumscribed circle).
bool touches(const LandArea& area, int32_t bx, int32_t bz, const WaveTrainBox& box) {
    if (box.length == 0 && box.width == 0) return true;
    const int64_t side = int64_t{block_cells} << area.step_log2;
    const LatticePoint corner = area.at(bx * block_cells, bz * block_cells);
    const BoxPosition centre = box_position(box, {corner.x + side / 2, corner.z + side / 2});
    if (!centre.in_reach) return true;
    // 3/4 of the side is above half its diagonal; 2 for the truncations.
    const int64_t radius = side * 3 / 4 + 2;
    if (box.length != 0 && (centre.u < -radius || centre.u > box.length + radius)) return false;
    return box.width == 0 || (centre.v >= -radius && centre.v <= box.width + radius);
}

}  // namespace

NodeField node_field(const LandArea& area, std::span<const float> depths, const BandGrid& grid,
                     const DepthResponse& response, const LandSettings& settings) {
    NodeField field;
    field.shift.assign(area.nodes(), 0);
    field.gain.assign(area.nodes(), unit_node_gain);
    if (grid.shift.empty()) return field;
    const double step = area.step();
    size_t n = 0;
    for (int32_t z = 0; z < area.nodes_z(); ++z) {
        for (int32_t x = 0; x < area.nodes_x(); ++x, ++n) {
            const BandGrid::Value here = grid.at(static_cast<double>(x), static_cast<double>(z));
            const auto depth = static_cast<double>(depths[n]);
            const bool open = depth >= response.untouched();
            if (open && here.shift == 0.0 && here.shelter == 1.0) continue;
            const double part = presence(area, static_cast<double>(x) * step, static_cast<double>(z) * step,
                                         settings.run_out);
            const double shelter = 1.0 + (here.shelter - 1.0) * part;
            const double gain =
                open ? shelter : std::min(shelter * response.growth(depth), response.breaking_gain(depth));
            field.shift[n] = node_shift(here.shift * part);
            field.gain[n] = node_gain(gain);
        }
    }
    return field;
}

std::vector<std::shared_ptr<LandBlock>> cut_blocks(const LandArea& area, const NodeField& field,
                                                   const WaveTrainBox& box) {
    std::vector<std::shared_ptr<LandBlock>> blocks;
    LandBlock block;
    for (int32_t bz = 0; bz < area.blocks_z; ++bz) {
        for (int32_t bx = 0; bx < area.blocks_x; ++bx) {
            if (!touches(area, bx, bz, box)) continue;
            block.key = {area.first.x + bx, area.first.z + bz};
            for (int32_t row = 0; row < block_nodes; ++row) {
                const size_t from =
                    static_cast<size_t>(bz * block_cells + row) * static_cast<size_t>(area.nodes_x()) +
                    static_cast<size_t>(bx * block_cells);
                const auto to = static_cast<size_t>(row * block_nodes);
                for (size_t i = 0; i < block_nodes; ++i) {
                    block.shift[to + i] = field.shift[from + i];
                    block.gain[to + i] = field.gain[from + i];
                }
            }
            if (!trivial(block)) blocks.push_back(std::make_shared<LandBlock>(block));
        }
    }
    return blocks;
}

}  // namespace trochoid
