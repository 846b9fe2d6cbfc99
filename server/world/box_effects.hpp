#pragma once
#include <cstdint>

#include "protocol/model/irregular_height.hpp"
#include "protocol/model/surface_noise.hpp"
#include "protocol/units/lattice.hpp"
#include "server/world/integer_math.hpp"

namespace trochoid {

/// A roundness of 0 to 1 as a box carries it (round_wave.hpp).
uint16_t roundness_units(double roundness);

/// Dominant wavelengths from group to group, along the wind and across, where nothing else is asked for.
inline constexpr double group_wavelengths = 6.0;

/// Irregular heights of a sea (paper A, eq. 8, in physical terms; row A8): from group to group `along` metres along u and `across`
/// metres to its side; the groups travel at `group_speed` m/s along u. `share` is a/A in [0, 1], u a unit vector; phases from the
/// seed. share 0 gives the default value (off).
IrregularHeight grouped_heights(double share, HeadingVector u, double along, double across,
                                double group_speed, uint64_t seed);

/// The paper's literal form as a preset: A' = A - a sin(t + u') sin(v'), t in seconds, u' = 2 pi u / along and v' = 2 pi v / across in
/// radians, u and v in metres from the box's corner. With `along` = 2 pi m (the paper's sin(t + u)) and f = 2 pi / across it is the
/// printed formula: a pattern that runs against the wind at 1 m/s.
IrregularHeight literal_heights(double share, HeadingVector u, double along, double across,
                                LatticePoint corner);

/// Capillary noise that a wind adds to its water (paper A, eq. 9): lattice step 0.5 m, a time step of 0.26 s, three octaves of half the
/// amplitude each, on the displayed surface only. `amplitude` in metres, 0 for none.
SurfaceNoise capillary_noise(float amplitude, uint64_t seed);

}  // namespace trochoid
