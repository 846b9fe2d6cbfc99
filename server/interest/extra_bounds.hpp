#pragma once
#include "protocol/model/ship_wake.hpp"
#include "protocol/model/surface_noise.hpp"

namespace trochoid {

/// What a box adds beside its trains: bounds at full gain.
struct ExtraBounds {
    double height = 0.0;        ///< m
    double displacement = 0.0;  ///< m
    double slope = 0.0;         ///< of the height, m/m
    double steepness = 0.0;     ///< of the horizontal displacement, m/m
    double longest = 0.0;       ///< m: the longest wave in it
};

/// Of both wake trains; zero without a wake.
ExtraBounds wake_extra(const ShipWake& wake);
/// Of all octaves; zero without noise. Noise does not move the water sideways.
ExtraBounds noise_extra(const SurfaceNoise& noise);

/// The longest wave of a ship's wake on deep water, lambda0 = 2 pi V^2 / g, m; 0 without a wake.
double longest_wave(const ShipWake& wake);
/// An octave of lattice step s counts as waves of length 2 s, m; 0 without noise.
double longest_wave(const SurfaceNoise& noise);

}  // namespace trochoid
