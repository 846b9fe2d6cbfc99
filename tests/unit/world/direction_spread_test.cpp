#include "server/world/direction_spread.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "server/world/dispersion.hpp"

namespace trochoid {
namespace {

constexpr double to_radians = pi / 180.0;

/// Share of a weight below `degrees` within ±60, by a plain sum.
template <typename Weight>
double plain_share(Weight weight, double degrees) {
    const int steps = 60'000;
    double below = 0.0;
    double all = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double at = -60.0 + 120.0 * (i + 0.5) / steps;
        all += weight(at);
        if (at < degrees) below += weight(at);
    }
    return below / all;
}

TEST(DirectionSpread, CosineSquareIsThePlainFormula) {
    const DirectionSpread spread(Spreading::cosine_squared, 1.0, 1.0, 10.0);
    const auto weight = [](double degrees) { return std::pow(std::cos(degrees * to_radians), 2); };
    // ∫ cos² over ±60° in degrees
    const double norm = (pi / 3.0 + std::sqrt(3.0) / 4.0) / to_radians;
    for (double degrees = -60.0; degrees <= 60.0; degrees += 7.5) {
        EXPECT_NEAR(spread.density(degrees), weight(degrees) / norm, 1e-6) << degrees;
        EXPECT_NEAR(spread.cumulative(degrees), plain_share(weight, degrees), 3e-5) << degrees;
    }
    EXPECT_EQ(spread.density(60.1), 0.0);
    EXPECT_EQ(spread.density(-75.0), 0.0);
}

TEST(DirectionSpread, HasselmannsExponentIsTheOnePublished) {
    EXPECT_NEAR(hasselmann_exponent(0.8, 0.8, 12.0), 6.97, 1e-12);
    EXPECT_NEAR(hasselmann_exponent(0.4, 0.8, 12.0), 6.97 * std::pow(0.5, 4.06), 1e-12);
    const double age = 12.0 * 0.8 / gravity;
    EXPECT_NEAR(hasselmann_exponent(1.6, 0.8, 12.0), 9.77 * std::pow(2.0, -2.33 - 1.45 * (age - 1.17)),
                1e-12);
    // Narrowest about the peak, wider towards both sides.
    EXPECT_GT(hasselmann_exponent(0.84, 0.8, 12.0), hasselmann_exponent(0.7, 0.8, 12.0));
    EXPECT_GT(hasselmann_exponent(0.84, 0.8, 12.0), hasselmann_exponent(1.2, 0.8, 12.0));
}

TEST(DirectionSpread, HasselmannIsThePlainFormulaAtEveryFrequency) {
    for (const double omega : {0.4, 0.6, 0.8, 0.9, 1.6, 3.0}) {
        const DirectionSpread spread(Spreading::hasselmann, omega, 0.8, 12.0);
        const double s = hasselmann_exponent(omega, 0.8, 12.0);
        const auto weight = [s](double degrees) {
            return std::pow(std::cos(0.5 * degrees * to_radians), 2.0 * s);
        };
        for (const double degrees : {-45.0, -20.0, 0.0, 5.0, 33.0, 60.0})
            EXPECT_NEAR(spread.cumulative(degrees), plain_share(weight, degrees), 5e-5)
                << omega << ", " << degrees;
    }
}

TEST(DirectionSpread, AutomaticIsHasselmann) {
    const DirectionSpread automatic(Spreading::automatic, 1.2, 0.8, 12.0);
    const DirectionSpread named(Spreading::hasselmann, 1.2, 0.8, 12.0);
    for (const double q : {0.0, 0.1, 0.6, 1.0}) EXPECT_EQ(automatic.quantile(q), named.quantile(q));
}

TEST(DirectionSpread, QuantilesInvertAndStayWithinSixtyDegrees) {
    for (const Spreading kind : {Spreading::cosine_squared, Spreading::hasselmann})
        for (const double omega : {0.2, 0.8, 1.3, 30.0}) {
            const DirectionSpread spread(kind, omega, 0.8, 20.0);
            EXPECT_EQ(spread.quantile(0.0), -60.0);
            EXPECT_EQ(spread.quantile(0.5), 0.0);
            EXPECT_EQ(spread.quantile(1.0), 60.0);
            double last = -60.0;
            for (int i = 1; i < 200; ++i) {
                const double degrees = spread.quantile(i / 200.0);
                EXPECT_GE(degrees, last);
                EXPECT_NEAR(spread.cumulative(degrees), i / 200.0, 1e-12);
                EXPECT_NEAR(spread.quantile(1.0 - i / 200.0), -degrees, 1e-9);
                last = degrees;
            }
        }
}

}  // namespace
}  // namespace trochoid
