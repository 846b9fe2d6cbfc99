#pragma once

// Logarithm, exponential, roots and directions for setting up winds. Each is computed with 113 bits by a library that knows
// only integers (Boost.Multiprecision, cpp_bin_float) and rounded to double once (or where it says so, by + - * / on doubles
// around such values), so every machine gets the same bits; libm differs from one C library to the next.
namespace trochoid {

inline constexpr double pi = 0x1.921fb54442d18p+1;

/// e^x for |x| <= 700, within 2 ulp; 0 below -700, an error above 700. Fast (tens of nanoseconds): + - * on doubles in a written
/// order, around a table of 2^(i/64) made once with 113 bits.
double exponential(double x);

/// tanh x for x >= 0, within 4 ulp: Lambert's continued fraction below 1/2, 1 - 2/(e^2x + 1) above, 1 from 22 on.
double hyperbolic_tangent(double x);

/// Natural logarithm of x > 0.
double natural_log(double x);

/// Cube root of x > 0.
double cube_root(double x);

/// x^y for x > 0.
double power(double x, double y);

/// sin(pi x) and cos(pi x).
double sine_of_half_turns(double x);
double cosine_of_half_turns(double x);

/// Unit vector of a heading (degrees clockwise from north, any value up to ±10^6): x east, z south.
struct HeadingVector {
    double east = 0.0;
    double south = -1.0;
    bool operator==(const HeadingVector&) const = default;
};
HeadingVector heading_vector(double degrees);

}  // namespace trochoid
