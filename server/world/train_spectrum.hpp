#pragma once
#include <cstdint>
#include <vector>

#include "protocol/model/wave_train.hpp"
#include "server/world/wind_sea.hpp"

namespace trochoid {

/// Frequency below which the share `quantile` in (0, 1) of the energy of a Pierson–Moskowitz spectrum lies, rad/s:
/// E(ω) = exp(-5/4 (ωp/ω)^4), inverted.
double energy_quantile(double peak_omega, double quantile);

/// Half-width in degrees of the directions at a frequency: 40 up to the peak, rising linearly to 60 at twice the peak.
/// The shape, narrowest at the peak, follows Hasselmann, Dunckel and Ewing (1980); ±60° is paper C's bound.
double spread_half_width(double omega, double peak_omega);

/// Deviation in [-1, 1], as a part of the half-width, below which the share `quantile` in [0, 1] of a cos² distribution
/// lies: F(t) = (1 + t)/2 + sin(πt)/(2π), inverted by a table (error below 1e-4).
double spread_quantile(double quantile);

/// `count` trains (1 to 64) of equal energy, by falling wavelength, choppiness 1, without land (rows A2, B1).
///
/// Frequencies: the medians of `count` strata of equal energy, each moved by up to a quarter of its stratum; one train
/// alone lies at the peak. Directions: the strata of a cos² distribution around `towards_degrees`, dealt to the
/// trains in an order shuffled by the seed. Phases uniform. Σ A²/2 = Hs²/16; one train alone has A = Hs/2 (a regular
/// wave of that height). All chance comes from splitmix64 of the seed.
std::vector<WaveTrain> wind_trains(const WindSea& sea, double towards_degrees, uint16_t count, uint64_t seed);

/// 4 √(Σ A²/2) in metres; 2 A for one train alone.
double significant_height(const std::vector<WaveTrain>& trains);

}  // namespace trochoid
