#pragma once
#include <array>
#include <cstddef>

#include "protocol/codec/messages.hpp"

namespace trochoid {

/// Directions lie within ±60° of the heading (paper C, section 3.2).
inline constexpr double widest_deviation = 60.0;

/// The exponent s of cos²ˢ(θ/2) by Hasselmann, Dunckel and Ewing (1980, J. Phys. Oceanogr. 10, 1264): with f = ω/ωp,
/// 6.97 f^4.06 below 1.05, 9.77 f^(-2.33 - 1.45 (U10/cp - 1.17)) from there on; cp = g/ωp. Narrowest at the peak.
double hasselmann_exponent(double omega, double peak_omega, double u10);

/// How directions spread about the heading at one frequency (row B1), restricted to ±60° and normalised there. `automatic` is
/// Hasselmann's. The distribution is symmetrical; energy is tabulated over [0°, 60°] by Simpson's rule.
class DirectionSpread {
public:
    /// ω and ωp in rad/s, U10 in m/s; cos² does not depend on them.
    DirectionSpread(Spreading spreading, double omega, double peak_omega, double u10);

    /// Density per degree at a deviation in degrees; 0 beyond ±60.
    double density(double degrees) const;
    /// Deviation in degrees, -60 to 60, below which the share `quantile` in [0, 1] lies; within 0.01°.
    double quantile(double quantile) const;
    /// The share of directions below a deviation, 0 to 1.
    double cumulative(double degrees) const;

private:
    static constexpr size_t cells = 128;
    double norm_ = 0.0;  ///< ∫ weight over [0, 60], degrees
    std::array<double, cells + 1> weight_{};
    std::array<double, cells + 1> share_{};  ///< of [0, deviation] in [0, 60]
};

}  // namespace trochoid
