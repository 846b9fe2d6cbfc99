#include "server/world/integer_math.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace trochoid {
namespace {

constexpr long double pi_l = 3.14159265358979323846264338327950288L;

TEST(IntegerMath, AgreesWithLongDoubleToTheLastBitsOfADouble) {
    for (double x : {1e-9, 0.003, 0.25, 0.5, 0.999, 1.0, 1.001, 2.0, 10.0, 12345.678, 1e12}) {
        const auto log = static_cast<double>(std::log(static_cast<long double>(x)));
        const auto root = static_cast<double>(std::cbrt(static_cast<long double>(x)));
        EXPECT_NEAR(natural_log(x), log, 1e-15 * std::abs(log)) << x;
        EXPECT_NEAR(cube_root(x), root, 1e-15 * root) << x;
    }
    for (double x = -2.0; x <= 2.0; x += 0.0625)
        EXPECT_NEAR(sine_of_half_turns(x), static_cast<double>(std::sin(pi_l * static_cast<long double>(x))),
                    1e-16)
            << x;
}

TEST(IntegerMath, ExponentialAndHyperbolicTangentAgreeWithLongDouble) {
    for (double x = -699.7; x < 700.0; x += 0.137) {
        const long double exact = std::exp(static_cast<long double>(x));
        EXPECT_LE(std::abs(static_cast<long double>(exponential(x)) - exact), 2.3e-16L * exact) << x;
    }
    EXPECT_EQ(exponential(0.0), 1.0);
    EXPECT_EQ(exponential(-1e300), 0.0);
    EXPECT_EQ(exponential(-std::numeric_limits<double>::infinity()), 0.0);
    for (double x = 1e-12; x < 30.0; x *= 1.013) {
        const long double exact = std::tanh(static_cast<long double>(x));
        EXPECT_LE(std::abs(static_cast<long double>(hyperbolic_tangent(x)) - exact), 4.5e-16L * exact) << x;
    }
    EXPECT_EQ(hyperbolic_tangent(0.0), 0.0);
    EXPECT_NEAR(power(1.7, -3.3), std::pow(1.7, -3.3), 1e-16);
    EXPECT_NEAR(cosine_of_half_turns(1.0 / 3.0), 0.5, 1e-16);
}

TEST(IntegerMath, HeadingsTurnClockwiseFromNorth) {
    const auto expect = [](double degrees, double east, double south) {
        const HeadingVector v = heading_vector(degrees);
        EXPECT_NEAR(v.east, east, 1e-16) << degrees;
        EXPECT_NEAR(v.south, south, 1e-16) << degrees;
    };
    expect(0.0, 0.0, -1.0);
    expect(90.0, 1.0, 0.0);
    expect(180.0, 0.0, 1.0);
    expect(270.0, -1.0, 0.0);
    expect(360.0, 0.0, -1.0);
    expect(-90.0, -1.0, 0.0);
    expect(45.0, std::sqrt(0.5), -std::sqrt(0.5));
    for (double degrees = -400.0; degrees < 400.0; degrees += 7.3) {
        const HeadingVector v = heading_vector(degrees);
        EXPECT_NEAR(v.east * v.east + v.south * v.south, 1.0, 3e-16) << degrees;
    }
}

}  // namespace
}  // namespace trochoid
