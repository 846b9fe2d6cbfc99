#pragma once
#include <cstdint>
#include <vector>

#include "protocol/units/ids.hpp"
#include "protocol/units/lattice.hpp"

namespace trochoid {

/// Why a wave ray's parameters change at an action point (paper A, section 2; row A5).
enum class ActionKind : uint8_t {
    shoaling_starts = 1,  ///< the bottom begins to be felt: kD < pi
    blocked = 2,          ///< land rises above the surface: gain 0
    water_again = 3,      ///< water behind the land: recovery starts
    recovered = 4,        ///< full height again
};

struct ActionPoint {
    LatticePoint at;
    ActionKind kind = ActionKind::shoaling_starts;
    bool operator==(const ActionPoint&) const = default;
};

/// One traced wave ray with its action points in order of travel; for debug views.
struct WaveRay {
    LatticePoint start;
    LatticePoint end;
    std::vector<ActionPoint> points;
    bool operator==(const WaveRay&) const = default;
};

}  // namespace trochoid
