#pragma once
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

LandArea land_area(const WaveTrainBox& box, const TerrainGrid& terrain, const LandSettings& settings);

/// Terrain with its belt: everything outside is exactly open_sea_depth deep.
LatticeRect belt_bounds(const TerrainGrid& terrain);

/// Depth in metres at every node, row-major, positive below sea level. Behind the box's rear side, where its waves have not
/// begun, it reads `deepest_depth` whatever lies there.
std::vector<float> node_depths(const LandArea& area, const WaveTrainBox& box, const TerrainGrid& terrain);

/// Metres; deeper than any bed (2^24 lattice units).
inline constexpr float deepest_depth = 32768.0F;

}  // namespace trochoid
