#pragma once
#include <cstdint>
#include <vector>

#include "client/scene/mip_levels.hpp"

namespace trochoid {

/// What foam looks like from near and from far, on a tile that repeats seamlessly; purely visual.
struct FoamDetail {
    uint32_t side = 0;
    /// One entry a mip level, finest first; each texel, 0 to 1, is (whitecap noise; lace of bubbles, evenly distributed; streaks,
    /// evenly distributed; another whitecap noise). Whitecap noise is 0.5 + n / 8 of a normally distributed n of variance 1.
    std::vector<MipLevel> levels;
};

/// Noise of cells and gradients, made normal and even by rank. `side` is a power of two.
FoamDetail make_foam_detail(uint32_t side, uint32_t seed);

}  // namespace trochoid
