#pragma once
#include <cstdint>

#include "protocol/codec/messages.hpp"

namespace trochoid {

/// The sea that a wind raises at the end of its fetch.
struct WindSea {
    double significant_height = 0.0;  ///< m, 4 √m0 over the used range
    double peak_omega = 0.0;          ///< rad/s
    bool operator==(const WindSea&) const = default;
};

/// Significant height and peak frequency of a wind of `speed` m/s at 19.5 m that has blown over `fetch` lattice units for
/// long (row A2): those of its spectrum (wind_spectrum). Fully developed, Hs = 0.209 U²/g, which is paper A's H = α h²/g with
/// α = 0.21 read as significant height with wind at 19.5 m.
WindSea wind_sea(double speed, int64_t fetch, Spectrum spectrum = Spectrum::automatic);

}  // namespace trochoid
