#pragma once
#include <span>

#include "protocol/model/sea.hpp"

// The ordered sum by arithmetic that the standard forbids: what programs compute that were built or written otherwise.
namespace trochoid::conformance {

/// A way to reckon: the standard's, or one that differs from it in one thing.
enum class Arithmetic : uint8_t {
    standard,
    fused,          ///< products and sums in one rounding, in the sum and in the normal
    wider,          ///< sums in double precision, rounded in the end
    four_sums,      ///< every fourth train into a sum of its own, as vector units are fed
    short_phases,   ///< phases of 24 bits, what a float of turns holds
    double_phases,  ///< phases in double precision, from turns as fractions
    library_sine,   ///< sine and cosine of the mathematical library
    fused_sine,     ///< the polynomials in fused steps
    unfolded_sine   ///< the polynomials as sums of powers
};

/// What the sea comes to at a rest point. By `standard` it is `instant.evaluate`.
SurfaceSample sample_by(Arithmetic how, const SeaInstant& instant, LatticePoint place);

/// The normal that the sample's own derivatives make, by the standard's arithmetic or fused.
SurfaceSample with_normal(SurfaceSample sample, bool fused);

}  // namespace trochoid::conformance
