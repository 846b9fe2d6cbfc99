#include "server/world/wind_sea.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "protocol/units/lattice.hpp"

namespace trochoid {
namespace {

TEST(WindSea, LongFetchesAreFullyDeveloped) {
    for (double speed : {2.0, 8.0, 14.0}) {
        const WindSea sea = wind_sea(speed, 1000 * 1000 * lattice_per_metre);
        EXPECT_DOUBLE_EQ(sea.significant_height, 0.21 * speed * speed / 9.80665);
        EXPECT_DOUBLE_EQ(sea.peak_omega, 0.877 * 9.80665 / speed);
    }
}

TEST(WindSea, ShortFetchesFollowJonswap) {
    for (double speed : {5.0, 14.0, 30.0})
        for (double metres : {100.0, 3000.0, 20000.0}) {
            const double u10 = speed / 1.026;
            const double x = 9.80665 * metres / (u10 * u10);
            if (x > 10000.0) continue;
            const WindSea sea = wind_sea(speed, to_lattice(metres));
            const double height = 0.0016 * std::sqrt(x) * u10 * u10 / 9.80665;
            const double omega = 22.0 * 9.80665 / u10 * std::pow(x, -1.0 / 3.0);
            EXPECT_NEAR(sea.significant_height, height, 1e-12 * height) << speed << ", " << metres;
            EXPECT_NEAR(sea.peak_omega, omega, 1e-12 * omega) << speed << ", " << metres;
        }
}

TEST(WindSea, HeightAndPeriodNeverFallWithFetchOrSpeed) {
    WindSea last{0.0, 1e9};
    for (double metres = 32.0; metres < 1e6; metres *= 1.5) {
        const WindSea sea = wind_sea(14.0, to_lattice(metres));
        EXPECT_GE(sea.significant_height, last.significant_height);
        EXPECT_LE(sea.peak_omega, last.peak_omega);
        last = sea;
    }
    for (double speed = 1.0; speed < 40.0; speed += 0.5)
        EXPECT_LT(wind_sea(speed, to_lattice(5000.0)).significant_height,
                  wind_sea(speed + 0.5, to_lattice(5000.0)).significant_height);
}

}  // namespace
}  // namespace trochoid
