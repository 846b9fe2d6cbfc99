#pragma once
#include <cstdint>
#include <vector>

#include "client/scene/mip_levels.hpp"

namespace trochoid {

/// Slopes of short waves on a tile that repeats seamlessly; purely visual (the detail that meshes cannot carry).
struct RippleMap {
    uint32_t side = 0;
    /// One entry a mip level, finest first; each texel is (slope along x, slope along z, their squares' sum, height of the
    /// ripples, 0 to 1), of which the third keeps the variance that averaging takes from the first two (LEAN mapping,
    /// Olano and Baker 2010).
    std::vector<MipLevel> levels;
};

/// Sum of sines with whole numbers of periods on the tile, amplitudes falling off like k^-1.2, spread about +x.
/// The root mean square slope is 1; shaders scale it. `side` is a power of two.
RippleMap make_ripple_map(uint32_t side, uint32_t seed);

}  // namespace trochoid
