#pragma once

#include <cstdint>

#include "server/import/map_projection.hpp"

namespace trochoid {

/// Equilibrium beach profile h = A * y^(2/3) (Dean 1977, Equilibrium beach profiles: U.S. Atlantic and Gulf coasts,
/// University of Delaware, Ocean Engineering Report 12). `a` in m^(1/3), 0.05 (fine sand) .. 0.3 (gravel and coarser);
/// `from_shore` and the result in metres.
double dean_depth(double a, double from_shore);

/// The depth, but never above `most`: equal to `depth` up to most / 2, then a parabola that meets `most` level at
/// 3/2 most. Value and slope are continuous. Metres.
double capped_depth(double depth, double most);

/// Shape of invented land.
struct LandShape {
    /// Metres that no hill exceeds.
    double top = 45.0;
    /// Rise of the hill foot, metres per metre inland.
    double slope = 0.1;
    /// Chooses the hills.
    uint32_t seed = 1;
};

/// Synthetic height of land, metres above the sea, in (0, top]: a shore step of 1.5 to 8 m over the first 50 m, and hills that
/// approach `top` with the distance from shore, both varied by value noise of 700 and 250 m. Not surveyed: looks only.
double synthetic_land_height(const LandShape& shape, double from_shore, EastNorth place);

}  // namespace trochoid
