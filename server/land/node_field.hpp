#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "protocol/model/land_field.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "server/land/band_march.hpp"
#include "server/land/depth_table.hpp"
#include "server/land/land_area.hpp"

namespace trochoid {

/// A band's field at the nodes of an area, row-major: what blocks hold.
struct NodeField {
    std::vector<int32_t> shift;   ///< 2^-16 turn
    std::vector<uint16_t> gain;   ///< Q1.15
    std::vector<uint16_t> orbit;  ///< Q2.14; empty: 1 everywhere
};

/// The marched band at the nodes that the grid holds; all others read open water. Gain = shelter * growth, at most what breaking
/// leaves, with the node's own depth: exactly 0 on land. Beyond the terrain's belt shift, shelter and orbit fade to the open
/// sea's over the run-out. A node within 2^-10 turn and 2^-11 of gain of open water is open water.
/// `tile_depths` are the depths' tile_minima; `wanted` tells which tiles are filled, the others keep what they hold.
/// `filled` is called for every row of blocks, in order, as soon as its nodes are there and while they are in the cache.
void fill_node_field(NodeField& field, const LandArea& area, std::span<const float> depths,
                     std::span<const float> tile_depths, std::span<const uint8_t> wanted,
                     const BandGrid& grid, const DepthTable& table, const LandSettings& settings,
                     const std::function<void(int32_t bz)>& filled);

/// First node of a block in an area.
size_t block_start(const LandArea& area, int32_t bx, int32_t bz);

/// Whether a block's square can touch the box (conservatively, by its circumscribed circle).
bool block_touches(const LandArea& area, int32_t bx, int32_t bz, const WaveTrainBox& box);

/// Whether a block of the field reads open water at all nodes.
bool block_is_open(const LandArea& area, const NodeField& field, int32_t bx, int32_t bz);

/// Copies a block's nodes out; `turned`: rows to columns.
void copy_block(LandBlock& block, const LandArea& area, const NodeField& field, int32_t bx, int32_t bz,
                bool turned);

/// Largest gain of a block.
uint16_t largest_gain(const LandBlock& block);

}  // namespace trochoid
