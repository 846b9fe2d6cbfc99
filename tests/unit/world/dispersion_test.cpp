#include "server/world/dispersion.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace trochoid {
namespace {

constexpr long double pi_l = 3.14159265358979323846264338327950288L;

/// ω of a quantised vector in 64-bit-mantissa arithmetic, turns per microsecond times 2^64.
long double exact_omega(QuantisedVector k) {
    const long double kx = k.kx;
    const long double kz = k.kz;
    const long double n = std::sqrt(kx * kx + kz * kz) * 2.0L * pi_l * 1024.0L / 4294967296.0L;
    const long double omega = std::sqrt(static_cast<long double>(gravity) * n +
                                        static_cast<long double>(surface_tension) * n * n * n);
    return omega / (2.0L * pi_l * 1e6L) * 18446744073709551616.0L;
}

TEST(Dispersion, FrequencyIsTheQuantisedVectorsToOneUnitOfQ64) {
    for (double wavelength = 0.05; wavelength < 4000.0; wavelength *= 1.07)
        for (double degrees = 0.0; degrees < 360.0; degrees += 37.0) {
            const QuantisedVector k = quantise(2.0 * pi / wavelength, heading_vector(degrees));
            const long double difference = static_cast<long double>(quantised_omega(k)) - exact_omega(k);
            EXPECT_LE(std::abs(difference), 1.0L) << wavelength << " m towards " << degrees;
        }
}

TEST(Dispersion, QuantisationKeepsLengthAndDirection) {
    for (double wavelength : {0.05, 1.0, 10.0, 150.0, 1000.0})
        for (double degrees = 0.0; degrees < 360.0; degrees += 13.0) {
            const HeadingVector d = heading_vector(degrees);
            const QuantisedVector k = quantise(2.0 * pi / wavelength, d);
            const double n = wave_number_of(k);
            // Half a unit on each axis; a unit is 1/4194304 turn per metre.
            const double bound = 0.75 * wavelength / 4194304.0;
            EXPECT_NEAR(n * wavelength / (2.0 * pi), 1.0, bound) << wavelength << ", " << degrees;
            const double cross = (k.kx * d.south - k.kz * d.east) / std::hypot(k.kx, k.kz);
            EXPECT_LE(std::abs(cross), bound) << wavelength << ", " << degrees;
        }
}

TEST(Dispersion, WaveNumberInvertsTheRelation) {
    for (double omega = 0.1; omega < 500.0; omega *= 1.3) {
        const double k = deep_wave_number(omega);
        EXPECT_NEAR(deep_omega(k), omega, 4e-16 * omega * 4.0) << omega;
    }
    // Gravity rules at 10 s (156 m), surface tension from about 1.7 cm down.
    EXPECT_NEAR(2.0 * pi / deep_wave_number(2.0 * pi / 10.0), gravity * 100.0 / (2.0 * pi), 0.001);
    const double cm = 2.0 * pi / 0.0170;
    EXPECT_NEAR(surface_tension * cm * cm * cm, gravity * cm, 0.01 * gravity * cm);
}

TEST(Dispersion, GroupSpeedIsTheSlopeOfTheRelation) {
    for (double omega : {0.3, 0.6, 1.0, 2.0}) {
        const double k = omega * omega / gravity;
        const double step = k * 1e-5;
        const double slope =
            (std::sqrt(gravity * (k + step)) - std::sqrt(gravity * (k - step))) / (2.0 * step);
        EXPECT_NEAR(deep_group_speed(omega), slope, 1e-6 * slope);
    }
}

}  // namespace
}  // namespace trochoid
