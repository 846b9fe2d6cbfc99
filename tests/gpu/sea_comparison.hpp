#pragma once
#include <cstddef>

#include "client/scene/camera.hpp"
#include "client/scene/draw_options.hpp"
#include "protocol/model/interest_state.hpp"
#include "protocol/model/sea.hpp"

namespace trochoid {

/// The state's sea on the CPU.
Sea sea_of(const InterestState& state);

/// A mesher's vertices against SeaInstant::evaluate at the very places that they are at.
struct Comparison {
    size_t vertices = 0;
    size_t moved = 0;          ///< with any displacement at all
    size_t changed = 0;        ///< by the layers that are left out
    size_t phase_differs = 0;  ///< in the digest of all phases
    size_t bits_differ = 0;    ///< in displacement or normal
    double worst_mm = 0;       ///< of displacement
    double worst_normal = 0;
};

/// Nothing fades; every seventh vertex is compared (bar R2). Prints what it found.
Comparison compare_sea(const InterestState& state, SeaTime now, const Camera& camera, DrawOptions options);

}  // namespace trochoid
