#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "protocol/model/land_field.hpp"
#include "protocol/model/terrain.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "server/land/land_settings.hpp"

namespace trochoid {

/// The nodes that a box's fields may touch: whole blocks over the box's bounds, clipped to the terrain with its belt
/// and the run-out around it. Beyond, the bed is the open sea's and the fields are trivial.
struct LandArea {
    uint8_t step_log2 = 15;
    /// First block and their number along x and z; no blocks: the box does not reach the terrain.
    BlockKey first;
    int32_t blocks_x = 0;
    int32_t blocks_z = 0;
    /// The terrain with its belt, in metres from node [0][0]; outside it the open sea's depth is exact.
    double belt_min_x = 0.0;
    double belt_min_z = 0.0;
    double belt_max_x = 0.0;
    double belt_max_z = 0.0;
    /// Where the box is limited on all sides and stands still: its corners in nodes from node [0][0], x and z in turn. Rays that
    /// pass it farther off than `corner_margin` nodes need not be marched.
    bool cornered = false;
    std::array<double, 8> corners{};
    static constexpr double corner_margin = 32.0;
    bool operator==(const LandArea&) const = default;

    bool empty() const { return blocks_x <= 0 || blocks_z <= 0; }
    int32_t nodes_x() const { return blocks_x * block_cells + 1; }
    int32_t nodes_z() const { return blocks_z * block_cells + 1; }
    size_t nodes() const { return static_cast<size_t>(nodes_x()) * static_cast<size_t>(nodes_z()); }
    /// Lattice position of a node.
    LatticePoint at(int32_t x, int32_t z) const;
    /// Node step in metres.
    double step() const { return static_cast<double>(int64_t{1} << step_log2) / 1024.0; }
};

/// A box with a course counts as everywhere: it may be steered, and its fields stay in the world frame.
LandArea land_area(const WaveTrainBox& box, const TerrainGrid& terrain, const LandSettings& settings);

/// Terrain with its belt: everything outside is exactly open_sea_depth deep.
LatticeRect belt_bounds(const TerrainGrid& terrain);

/// Depth in metres at every node, row-major, positive below sea level raised by `run_up` metres. Behind the rear side of a box that
/// stands still, where its waves have not begun, it reads `deepest_depth` whatever lies there.
std::vector<float> node_depths(const LandArea& area, const WaveTrainBox& box, const TerrainGrid& terrain,
                               double run_up);

/// Metres; deeper than any bed (2^24 lattice units).
inline constexpr float deepest_depth = 32768.0F;

}  // namespace trochoid
