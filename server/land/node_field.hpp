#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/model/land_field.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "server/land/band_march.hpp"
#include "server/land/depth_response.hpp"
#include "server/land/land_area.hpp"

namespace trochoid {

/// A band's field at the nodes of an area, row-major: what blocks hold.
struct NodeField {
    std::vector<int32_t> shift;  ///< 2^-16 turn
    std::vector<uint16_t> gain;  ///< Q1.15
};

/// The marched band at the nodes. Gain = shelter * growth, at most what breaking leaves, with the node's own depth: exactly 0 on land.
/// Beyond the terrain's belt shift and shelter fade to the open sea's over the run-out. A node within 2^-10 turn and 2^-11 of gain
/// of open water is open water.
NodeField node_field(const LandArea& area, std::span<const float> depths, const BandGrid& grid,
                     const DepthResponse& response, const LandSettings& settings);

/// Blocks that are not trivial and touch the box, by ascending (z, x).
std::vector<std::shared_ptr<LandBlock>> cut_blocks(const LandArea& area, const NodeField& field,
                                                   const WaveTrainBox& box);

}  // namespace trochoid
