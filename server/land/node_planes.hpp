#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "server/land/bilinear.hpp"
#include "server/land/depth_table.hpp"
#include "server/land/land_area.hpp"
#include "server/land/tile_marks.hpp"
#include "server/land/wave_bands.hpp"

namespace trochoid {

/// What the depth at an area's nodes means to a band, row-major. Filled are only the tiles that a march may read: those within three
/// tiles of what is marked.
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
/// a noisy shore does not scatter phases between nodes; deep stays exactly deep away from shallows. A part of the area at a time.
class PhaseDepths {
public:
    PhaseDepths(const LandArea& area, std::span<const float> depths, const WaveBand& band,
                const DepthTable& table);

    /// Works out these nodes, all within the area.
    void take(NodeRows rows, IndexRange columns);
    /// Phase depth of node (column, z) of those taken, and of those east of it.
    const float* at(int32_t column, int32_t z) const {
        return part_.data() + static_cast<size_t>(z - first_row_) * width_ +
               static_cast<size_t>(column - first_column_);
    }

private:
    std::span<const float> depths_;
    int32_t nx_;
    int32_t nz_;
    float shallowest_;
    float deep_;
    int32_t passes_;
    int32_t first_row_ = 0;
    int32_t first_column_ = 0;
    size_t width_ = 0;
    std::vector<float> part_;
    std::vector<float> spare_;
};

/// Nodes over which a change of one depth spreads in phase depths; at most 8.
int32_t phase_depth_passes(const LandArea& area, const WaveBand& band);

}  // namespace trochoid
