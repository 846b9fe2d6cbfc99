#include "server/world/wind_sea.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "protocol/units/lattice.hpp"

namespace trochoid {
namespace {

TEST(WindSea, LongFetchesAreFullyDeveloped) {
    for (double speed : {2.0, 8.0, 14.0}) {
        const WindSea sea = wind_sea(speed, 1000 * 1000 * lattice_per_metre);
        EXPECT_NEAR(sea.significant_height, 0.21 * speed * speed / 9.80665, 0.007 * sea.significant_height);
        EXPECT_NEAR(sea.peak_omega, 0.877 * 9.80665 / speed, 3e-4 * sea.peak_omega);
    }
}

TEST(WindSea, ShortFetchesFollowJonswap) {
    for (double speed : {5.0, 14.0, 30.0})
        for (double metres : {100.0, 3000.0, 20000.0}) {
            const double u10 = speed / 1.0601973;
            const double x = 9.80665 * metres / (u10 * u10);
            if (x > 10000.0) continue;
            const WindSea sea = wind_sea(speed, to_lattice(metres));
            const double height = 0.0012582 * std::pow(x, 2.0 / 3.0 - 0.11) * u10 * u10 / 9.80665;
            const double omega = 22.0 * 9.80665 / u10 * std::pow(x, -1.0 / 3.0);
            // The used range leaves up to 1.5 % of the energy of the shortest sea out (no wave below 5 cm).
            EXPECT_NEAR(sea.significant_height, height, 0.008 * height) << speed << ", " << metres;
            EXPECT_NEAR(sea.peak_omega, omega, 1e-6 * omega) << speed << ", " << metres;
        }
}

TEST(WindSea, HeightAndPeriodNeverFallWithFetchOrSpeed) {
    for (const double speed : {3.0, 8.0, 14.0, 25.0}) {
        WindSea last{0.0, 1e9};
        for (double metres = 32.0; metres < 1e6; metres *= 1.1) {
            const WindSea sea = wind_sea(speed, to_lattice(metres));
            // At full development the two spectra's ranges part by a few parts in 1000.
            EXPECT_GE(sea.significant_height, 0.997 * last.significant_height) << speed << ", " << metres;
            EXPECT_LE(sea.peak_omega, last.peak_omega) << speed << ", " << metres;
            last = sea;
        }
    }
    for (double speed = 1.0; speed < 39.0; speed += 0.5)
        for (const Spectrum spectrum : {Spectrum::automatic, Spectrum::pierson_moskowitz, Spectrum::neumann})
            EXPECT_LT(wind_sea(speed, to_lattice(5000.0), spectrum).significant_height,
                      wind_sea(speed + 0.5, to_lattice(5000.0), spectrum).significant_height);
}

}  // namespace
}  // namespace trochoid
