#pragma once
#include <cstdint>

#include "server/world/integer_math.hpp"

namespace trochoid {

/// Standard acceleration of gravity, m/s².
inline constexpr double gravity = 9.80665;
/// Surface tension over density of sea water, m³/s²: 0.0743 N/m / 1026 kg/m³ at 15 °C and 35 g/kg (Nayar et al. 2014,
/// "Surface tension of seawater", J. Phys. Chem. Ref. Data 43, 043103).
inline constexpr double surface_tension = 7.2e-5;

/// A wave vector as it travels: turns per lattice unit, Q0.32.
struct QuantisedVector {
    int32_t kx = 0;
    int32_t kz = 0;
    bool operator==(const QuantisedVector&) const = default;
};

/// Angular frequency in rad/s of a wave number in rad/m on deep water: ω² = g k + (γ/ρ) k³ (paper B, section 2; row B2
/// with tanh kD = 1).
double deep_omega(double wave_number);

/// The inverse: wave number in rad/m of an angular frequency in (0, 1000] rad/s, to a few ulp.
double deep_wave_number(double omega);

/// Nearest wave vector to a wave number (rad/m, below 3000) and a unit direction.
QuantisedVector quantise(double wave_number, HeadingVector direction);

/// Length of a quantised wave vector in rad/m.
double wave_number_of(QuantisedVector k);

/// Frequency of a quantised wave vector on deep water, turns per microsecond, Q0.64, rounded to nearest: the quantised
/// wave is the truth. Differs from the exact value by at most 1 unit.
uint64_t quantised_omega(QuantisedVector k);

/// Group speed in m/s of gravity waves on deep water: g / (2 ω).
double deep_group_speed(double omega);

}  // namespace trochoid
