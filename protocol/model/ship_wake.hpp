#pragma once
#include <array>
#include <cstdint>

#include "protocol/units/result.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// Kelvin wake of a ship on deep water (paper B, "ship waves"; row B11) as two trains whose phase and gain come from one normative table
/// in ship axes. Lengths are scaled by lambda0 = 2 pi V^2 / g. The ship is at the middle of the box's front edge (u = length, v = width/2);
/// the box moves with it (one CourseLeg along u). Both amplitudes 0 = no wake.
struct ShipWake {
    float transverse =
        0.0F;  ///< amplitude, m, of the transverse train on the axis, times the root of the distance in lambda0 (full from two lambda0): 0, or 2^-20 to 32
    float diverging = 0.0F;   ///< the same of the diverging train, at its strongest
    float choppiness = 0.0F;  ///< horizontal over vertical orbit, 0 to 4
    /// 2^40 / lambda0 in lattice units, 2^20 (1049 m) to 2^31 (0.5 m).
    uint32_t inverse_length = 0;
    /// Speed in ship axes at which the pattern's rear end falls behind the ship, and, after the box's `end`, its front end: half the
    /// ship's speed (the group speed), Q.24 lattice units per microsecond.
    uint32_t group_speed = 0;
    bool operator==(const ShipWake&) const = default;
};

inline constexpr bool has_wake(const ShipWake& w) { return w.transverse != 0.0F || w.diverging != 0.0F; }

/// Cells of the table over tau = |v'|/u' in [0, 3/8] (the cusp lies at 1/sqrt 8 = 0.3536).
inline constexpr int wake_cells = 768;

/// One wave system over tau, Q.24 each: phase of u' = lambda0 (turns), unit direction of its waves in ship axes (along the
/// course, outwards), gain.
struct WakeNode {
    int32_t phase = 0;
    int32_t along = 0;
    int32_t outwards = 0;
    int32_t gain = 0;
    bool operator==(const WakeNode&) const = default;
};
/// Cells of the table of 1/sqrt(m) over m in [1, 4).
inline constexpr int wake_root_cells = 96;
struct WakeTable {
    std::array<WakeNode, wake_cells + 1> transverse{};
    std::array<WakeNode, wake_cells + 1> diverging{};
    /// Q.24: how the amplitude falls with the distance, 1/sqrt(behind / lambda0), over an even power of two.
    std::array<int32_t, wake_root_cells + 1> root{};
};
/// Normative; made once by + - * / sqrt on doubles in a written order, rounded to nearest.
const WakeTable& wake_table();

/// One train of the wake at a point: as the ordered sum takes it.
struct WakeWave {
    uint32_t phase = 0;     ///< turns, Q0.32
    uint32_t gain = 0;      ///< Q0.24
    float dgain_du = 0.0F;  ///< 1/m, along the box's u and v
    float dgain_dv = 0.0F;
    float ku = 0.0F, kv = 0.0F;  ///< gradient of the phase, rad/m
    float du = 0.0F, dv = 0.0F;  ///< unit direction of travel
    bool operator==(const WakeWave&) const = default;
};
struct WakeSample {
    WakeWave transverse;
    WakeWave diverging;
};
/// Ship's speed, m/s, twice the group speed: the pattern's angular frequency at a fixed place is speed * ku.
float wake_speed(const ShipWake& wake);
/// behind: lattice units behind the ship along the course (> 0 behind); aside: lattice units to the right of the course.
/// rear and front: distances behind the ship between which the pattern stands (from age and time since end).
WakeSample wake_at(const ShipWake& wake, int64_t behind, int64_t aside, int64_t rear, int64_t front);

/// Bound of |height| anywhere, metres.
double wake_bound(const ShipWake& wake);

Result<Done> validate(const ShipWake& wake);

}  // namespace trochoid
