#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "server/land/depth_table.hpp"
#include "server/land/land_area.hpp"
#include "server/land/tile_marks.hpp"
#include "server/land/wave_bands.hpp"

namespace trochoid {

/// What the depth at an area's nodes means to a band, row-major.
struct NodePlanes {
    /// Per node the wave number in turns per node.
    std::vector<float> wave_numbers;
    /// Per node the largest share of the height that passes.
    std::vector<float> limits;
    /// Where wave numbers may differ from the open sea's and limits from 1; spread.
    static constexpr uint8_t bends = 1;
    static constexpr uint8_t breaks = 2;
    TileMarks marks;
    /// Smallest along = x * dx + z * dz, in nodes, of the nodes that the march may feel; none: nothing is touched.
    double first_along = 0.0;
    bool touched = false;
    /// For reuse from band to band.
    std::vector<float> smooth;
    std::vector<float> row;
};

/// Rows of nodes [from, to).
struct NodeRows {
    int32_t from = 0;
    int32_t to = 0;
};

/// Fills the planes in `rows`; what the others hold, and whether they are touched, is left open. `tile_depths` are the depths' tile_minima. `straight`: over land the wave number is the open sea's (Refraction::straight), else that of depth_min.
void fill_node_planes(NodePlanes& planes, const LandArea& area, std::span<const float> depths,
                      std::span<const float> tile_depths, NodeRows rows, const WaveBand& band,
                      const DepthTable& table, bool straight);

/// Depths limited to [shallowest, deep] and averaged over about a quarter wave length (binomial passes at node scale), so that
/// a noisy shore does not scatter phases between nodes; deep stays exactly deep away from shallows.
void phase_depths(std::vector<float>& smooth, std::vector<float>& row, const LandArea& area,
                  std::span<const float> depths, NodeRows rows, const WaveBand& band,
                  const DepthTable& table);

/// Nodes over which a change of one depth spreads in phase_depths.
int32_t phase_depth_passes(const LandArea& area, const WaveBand& band);

}  // namespace trochoid
