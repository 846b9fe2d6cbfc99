#pragma once
#include <cstdint>

#include "protocol/model/simd/sea_grid.hpp"

namespace trochoid {

/// Long waves on a coarser grid, interpolated between its points (paper B, row B8): for display alone, never authoritative.
struct CoarseOptions {
    int factor = 8;       ///< coarse step over grid step: 2, 4, 8 or 16; anything else is our bug
    double ratio = 24.0;  ///< trains at least `ratio` coarse steps long are interpolated
};

/// What a coarse evaluation left out, at most, at any point of the grid.
struct CoarseBound {
    double height = 0.0;      ///< m, of ay
    double horizontal = 0.0;  ///< m, of ax and of az
    double slope = 0.0;       ///< of yx, yz
    int trains = 0;           ///< interpolated
};

/// evaluate_grid, but trains that are long against the coarse step come by bilinear interpolation of their sums. For a train of amplitude
/// A, gain g and wave vector (kx, kz) that errs by at most A g (kx^2 Hx^2 + kz^2 Hz^2) / 8 in height, H being the coarse steps
/// (chi times that horizontally, k times that in slopes); the sum over the trains, and a part in 10^5 of their amplitudes for rounding, is the
/// bound returned. A train is interpolated only where its box's envelope is full all over the grid, without irregular heights, round
/// waves or land: everything else is evaluated at every point. The same on every machine and number of threads.
CoarseBound evaluate_coarse_grid(const SeaInstant& sea, const LatticeGrid& grid, const SurfacePlanes& planes,
                                 const CoarseOptions& options, Workers& workers);

}  // namespace trochoid
