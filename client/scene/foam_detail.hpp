#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace trochoid {

/// What foam looks like from near and from far, on a tile that repeats seamlessly; purely visual.
struct FoamDetail {
    uint32_t side = 0;
    /// One entry a mip level, finest first; each texel is (whitecap noise, normally distributed about 0 with variance 1; lace of
    /// bubbles, evenly distributed, 0 to 1; streaks, evenly distributed; square of the first, which keeps the variance that averaging
    /// takes from it).
    std::vector<std::vector<std::array<float, 4>>> levels;
};

/// Noise of cells and gradients, made normal and even by rank. `side` is a power of two.
FoamDetail make_foam_detail(uint32_t side, uint32_t seed);

}  // namespace trochoid
