#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/model/land_field.hpp"
#include "server/land/land_area.hpp"
#include "server/land/wave_bands.hpp"

namespace trochoid {

/// A band with the blocks that the land gives it.
struct BandBlocks {
    const WaveBand* band = nullptr;
    std::vector<std::shared_ptr<LandBlock>> blocks;
};

/// Steepness, the sum over the bands of gain * choppiness * A * |k'|, over that of open water.
struct GrowthLimit {
    /// Its largest value in any cell after limiting, at least 1.
    double growth = 1.0;
    /// Cells in which it was above growth_max.
    uint64_t limited_cells = 0;
};

/// Where shoaling and refraction make the waves steeper than growth_max times open water's, they break: lowers the gains of all
/// bands alike at the nodes around. Nodes that are open water for a band stay so, since their neighbours may have no
/// block; `growth` says what is left.
GrowthLimit limit_growth(const LandArea& area, std::span<BandBlocks> bands, double growth_max);

}  // namespace trochoid
