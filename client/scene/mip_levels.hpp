#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace trochoid {

/// A mip level of a square tile: four values a texel, row by row.
using MipLevel = std::vector<std::array<float, 4>>;

/// The level with its coarser ones down to one texel, finest first, each texel the mean of four. `side` is a power of two.
std::vector<MipLevel> with_coarser_levels(MipLevel finest, uint32_t side);

}  // namespace trochoid
