#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "protocol/model/land_field.hpp"
#include "protocol/model/terrain.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "server/land/band_march.hpp"
#include "server/land/depth_response.hpp"
#include "server/land/growth_limit.hpp"
#include "server/land/land_area.hpp"
#include "server/land/land_memory.hpp"
#include "server/land/land_settings.hpp"
#include "server/land/node_field.hpp"
#include "server/land/node_planes.hpp"
#include "server/land/wave_bands.hpp"
#include "server/world/traced_land.hpp"

namespace trochoid {

/// The nodes as a band's march sees them: where the band travels rather along x than along z, x and z are exchanged (`turned`), so
/// that its rows run along the memory.
struct BandView {
    bool turned = false;
    WaveBand band;
    const LandArea* area = nullptr;
    std::span<const float> depths;
    std::span<const float> tile_depths;
    /// Per block, row-major, whether it can touch the box; per tile of nodes, whether such a block has some of them.
    std::span<const uint8_t> touching;
    std::span<const uint8_t> touching_tiles;
};

/// All that the bands of a box have in common.
struct TraceInput {
    const WaveTrainBox& box;
    const LandSettings& settings;
    LandArea area{};
    std::vector<float> depths{};
    /// The same with x and z exchanged, where a band needs them.
    LandArea turned_area{};
    std::vector<float> turned_depths{};
    /// tile_minima of either.
    std::vector<float> tile_depths{};
    std::vector<float> turned_tile_depths{};
    /// BandView::touching and touching_tiles of either.
    std::vector<uint8_t> touching{};
    std::vector<uint8_t> touching_tiles{};
    std::vector<uint8_t> turned_touching{};
    std::vector<uint8_t> turned_touching_tiles{};
    float least_depth = 0.0F;
    /// Of the open sea, run-up included.
    double open_depth = 0.0;
    /// The box's significant height, metres.
    double height = 0.0;
    std::vector<WaveBand> bands{};
    /// growth_allowances.
    std::vector<double> allowed{};
    bool with_stats = false;

    BandView view(size_t band) const;
};
TraceInput trace_input(const WaveTrainBox& box, const TerrainGrid& terrain, const LandSettings& settings,
                       bool with_stats);
DepthResponse response_of(const TraceInput& in, const WaveBand& band);

/// Block of the area that the view's block (bx, bz) is, as offsets from its first.
struct BlockOffset {
    int32_t x;
    int32_t z;
};
inline BlockOffset block_in_area(const BandView& view, int32_t bx, int32_t bz) {
    return view.turned ? BlockOffset{bz, bx} : BlockOffset{bx, bz};
}
/// Index of an area's block (bx, bz) in what is kept per block of a view (live, growth).
inline size_t block_index(const BandView& view, int32_t bx, int32_t bz) {
    const BlockOffset at = block_in_area(view, bx, bz);
    return static_cast<size_t>(at.z) * static_cast<size_t>(view.area->blocks_x) + static_cast<size_t>(at.x);
}
/// Copies the area's block (bx, bz) out of the view's field, key and all.
void copy_block_of(LandBlock& block, const TraceInput& in, const BandView& view, const NodeField& field,
                   int32_t bx, int32_t bz);
/// Whether the area's block (bx, bz) is open water in the view's field.
bool block_of_is_open(const BandView& view, const NodeField& field, int32_t bx, int32_t bz);

/// Large buffers that a thread uses for one band after the other.
struct TraceWorkspace {
    NodePlanes planes;
    BandGrid grid;
    NodeField field;
    std::vector<uint8_t> live;
};

/// From which row of the march on a trace is to be taken up, and what is known of the land's change.
struct BandRestart {
    /// Good up to the row where the march goes on.
    std::vector<MarchCheckpoint> checkpoints;
    /// BandMemory::tile_hashes before the change.
    std::span<const uint64_t> tile_hashes;
    /// The view's blocks, row-major: those with a node whose depth has changed.
    std::vector<uint8_t> blocks;
    /// Smallest along = x * dx + z * dz (the view's nodes) of nodes that may have changed.
    double along = 0.0;
};

/// One band's outcome in the workspace's field, in its view: blocks marked live are not open water.
struct BandOutcome {
    std::shared_ptr<BandMemory> memory;
    /// Squared, over the blocks that were decided.
    BandGrowth growth;
    bool touched = false;
    /// Blocks that a restart has decided anew, row-major; all others are as they were. Empty: all were decided.
    std::vector<uint8_t> decided;
};
BandOutcome trace_band(const TraceInput& in, size_t band, TraceWorkspace& work, const BandRestart* restart);

/// Sets the land's steepness growths from the bands' (1: untouched).
void take_growth(TracedLand& land, const TraceInput& in, const std::vector<float>& growths);

/// Nodes before the first changed one that a restarted march has to hold: a tile of the march, the block that touches it and the one
/// beside it that its growth limit changes (16 rows and two blocks' diagonals), the cells around that, and some to spare. Of the
/// blocks farther out, which only limit these, no other nodes count.
inline constexpr double restart_margin = 76.0;

/// Runs work(i, workspace) for i in [0, count) on up to `threads` threads (0: the machine's); which thread does which changes nothing.
void for_each_band(size_t count, uint32_t threads, const std::function<void(size_t, TraceWorkspace&)>& work);

}  // namespace trochoid
