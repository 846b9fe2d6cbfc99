#pragma once

// Logarithm, roots and directions for setting up winds. Each is computed with 113 bits by a library that knows only
// integers (Boost.Multiprecision, cpp_bin_float) and rounded to double once, so every machine gets the same bits;
// libm differs from one C library to the next.
namespace trochoid {

inline constexpr double pi = 0x1.921fb54442d18p+1;

/// Natural logarithm of x > 0.
double natural_log(double x);

/// Cube root of x > 0.
double cube_root(double x);

/// sin(pi x).
double sine_of_half_turns(double x);

/// Unit vector of a heading (degrees clockwise from north, any value up to ±10^6): x east, z south.
struct HeadingVector {
    double east = 0.0;
    double south = -1.0;
    bool operator==(const HeadingVector&) const = default;
};
HeadingVector heading_vector(double degrees);

}  // namespace trochoid
