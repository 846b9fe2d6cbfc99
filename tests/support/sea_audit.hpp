#pragma once
#include <cstddef>
#include <cstdint>

#include "protocol/codec/messages.hpp"

namespace trochoid {

/// One wind to be audited: does the sea that is computed from its box have the heights and periods of its spectrum?
struct AuditCase {
    double speed = 12.0;  ///< m/s at 19.5 m
    double fetch = 80e3;  ///< m
    Spectrum spectrum = Spectrum::automatic;
    uint16_t trains = 256;
    uint16_t directions = 0;
    uint64_t seed = 1;
};

struct AuditEffort {
    size_t instants = 64;  ///< for heights: instants times points
    size_t points = 256;
    size_t gauges = 8;   ///< for periods: rest points watched
    double waves = 200;  ///< peak periods for which each is watched
};

/// Heights in metres, periods in seconds.
struct AuditResult {
    Spectrum kind = Spectrum::automatic;  ///< the one that was used
    double dimensionless_fetch = 0.0;     ///< g F/U10², at most jonswap_full_development

    // What the spectrum's own integrals over its used range say.
    double spectrum_height = 0.0;  ///< 4 √m0
    double spectrum_peak = 0.0;    ///< Tp
    double spectrum_mean = 0.0;    ///< Tm02 = 2π √(m0/m2)

    // What the literature says.
    double published_height = 0.0;
    double published_peak = 0.0;

    // What the trains add up to.
    double train_height = 0.0;
    double train_peak =
        0.0;  ///< of the energy binned over frequency, triangular bins of ±12 % of the median frequency
    double train_mean = 0.0;

    // What was measured on the sea, at rest points in the grown inside of the box.
    double surface_height =
        0.0;  ///< 4 standard deviations of y over instants and points spread over three months
    double surface_mean = 0.0;  ///< mean time between zero up-crossings of y
};

AuditResult audit(const AuditCase& wind, const AuditEffort& effort);

}  // namespace trochoid
