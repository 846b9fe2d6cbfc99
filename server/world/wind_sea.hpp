#pragma once
#include <cstdint>

#include "protocol/units/lattice.hpp"

namespace trochoid {

/// The sea that a wind raises at the end of its fetch.
struct WindSea {
    double significant_height = 0.0;  ///< m
    double peak_omega = 0.0;          ///< rad/s
    bool operator==(const WindSea&) const = default;
};

/// Significant height and peak frequency of a wind of `speed` m/s at 19.5 m that has blown over `fetch` lattice units for
/// long (row A2).
///
/// Fully developed: Hs = 0.21 U²/g, read with wind at 19.5 m as Pierson and Moskowitz (1964) do, and ωp = 0.877 g/U
/// (their spectrum's peak, row B1). On a short fetch F, with x = g F/U10² (Hasselmann et al. 1973, JONSWAP):
/// g Hs/U10² = 0.0016 √x and ωp = 22 (g² / (U10 F))^(1/3), U10 = U19.5/1.026 (Stewart 2008, "Introduction to
/// Physical Oceanography", section 16.4). The lower height and the higher frequency count; both laws meet near
/// x = 19,000 (360 km for 14 m/s). The shape stays Pierson and Moskowitz' at every fetch.
WindSea wind_sea(double speed, int64_t fetch);

}  // namespace trochoid
