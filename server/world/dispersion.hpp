#pragma once
#include <cstdint>

#include "server/world/integer_math.hpp"

// The full dispersion relation of surface waves (paper B, section 2; row B2), omega^2 = (g k + (gamma/rho) k^3) tanh(k D), by
// + - * / sqrt on doubles in a written order and hyperbolic_tangent, hence the same bits on every machine. Against 50 digits:
// omega within 1e-15, group speed and the inverse within 3e-15, relative, over the ranges below.
namespace trochoid {

/// Standard acceleration of gravity, m/s².
inline constexpr double gravity = 9.80665;
/// Surface tension over density of sea water, m³/s²: 0.0743 N/m / 1026 kg/m³ at 15 °C and 35 g/kg (Nayar et al. 2014,
/// "Surface tension of seawater", J. Phys. Chem. Ref. Data 43, 043103).
inline constexpr double surface_tension = 7.2e-5;

/// Depth in metres that stands for "no bed in reach": tanh(k D) = 1 for every wave shorter than 280 km.
inline constexpr double deep_water = 1e6;

/// Ranges in which the functions below hold: waves of 2 mm to 63 km over 1 cm to 12 km of water, or deep_water.
inline constexpr double smallest_wave_number = 1e-4;   ///< rad/m
inline constexpr double largest_wave_number = 3000.0;  ///< rad/m
inline constexpr double smallest_depth = 0.01;         ///< m
inline constexpr double largest_depth = 12000.0;       ///< m

/// A wave vector as it travels: turns per lattice unit, Q0.32.
struct QuantisedVector {
    int32_t kx = 0;
    int32_t kz = 0;
    bool operator==(const QuantisedVector&) const = default;
};

/// Angular frequency in rad/s of a wave number in rad/m over water of `depth` metres.
double wave_omega(double wave_number, double depth);

/// The inverse: wave number in rad/m of an angular frequency in rad/s, both in the ranges above.
double wave_number_at(double omega, double depth);

/// Group speed d omega / d k in m/s: (omega / 2k) ((g + 3 s k^2) / (g + s k^2) + 2 k D / sinh(2 k D)), s = gamma/rho.
double group_speed_at(double wave_number, double depth);

/// Angular frequency in rad/s of a wave number in rad/m on deep water: ω² = g k + (γ/ρ) k³.
double deep_omega(double wave_number);

/// The inverse: wave number in rad/m of an angular frequency in (0, 2000] rad/s, to a few ulp.
double deep_wave_number(double omega);

/// Nearest wave vector to a wave number (rad/m, below 3000) and a unit direction.
QuantisedVector quantise(double wave_number, HeadingVector direction);

/// Length of a quantised wave vector in rad/m.
double wave_number_of(QuantisedVector k);

/// Frequency of a quantised wave vector over water of `depth` metres, turns per microsecond, Q0.64, rounded to nearest: the
/// quantised wave is the truth. Differs from the exact value by at most 1 unit.
uint64_t quantised_omega(QuantisedVector k, double depth = deep_water);

}  // namespace trochoid
