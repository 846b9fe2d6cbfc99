#include "server/world/dispersion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <string>
#include <vector>

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

/// 50 decimal digits.
using Digits = boost::multiprecision::cpp_bin_float_50;

Digits exact_square(const Digits& k, const Digits& depth) {
    const Digits g(gravity);
    const Digits s(surface_tension);
    return (g * k + s * k * k * k) * tanh(Digits(k * depth));
}

/// dω/dk by the product rule, from sinh and cosh: no shared form with the code.
Digits exact_group_speed(const Digits& k, const Digits& depth) {
    const Digits g(gravity);
    const Digits s(surface_tension);
    const Digits c = cosh(Digits(k * depth));
    const Digits slope =
        (g + 3 * s * k * k) * tanh(Digits(k * depth)) + (g * k + s * k * k * k) * depth / (c * c);
    return slope / (2 * sqrt(exact_square(k, depth)));
}

double relative(double value, const Digits& exact) {
    return std::abs(static_cast<double>((Digits(value) - exact) / exact));
}

/// Wave numbers and depths over the stated ranges, their ends among them.
std::vector<double> between(double low, double high, int count) {
    std::vector<double> list;
    for (int i = 0; i <= count; ++i)
        list.push_back(low * std::pow(high / low, i / static_cast<double>(count)));
    list.front() = low;
    list.back() = high;
    return list;
}

TEST(Dispersion, FullRelationAgreesWithFiftyDigitsOverItsRange) {
    double worst_omega = 0.0;
    double worst_speed = 0.0;
    double worst_number = 0.0;
    for (const double k : between(smallest_wave_number, largest_wave_number, 37))
        for (const double depth : between(smallest_depth, largest_depth, 31)) {
            const Digits omega = sqrt(exact_square(k, depth));
            worst_omega = std::max(worst_omega, relative(wave_omega(k, depth), omega));
            worst_speed =
                std::max(worst_speed, relative(group_speed_at(k, depth), exact_group_speed(k, depth)));
            worst_number =
                std::max(worst_number, relative(wave_number_at(static_cast<double>(omega), depth), k));
        }
    EXPECT_LT(worst_omega, 1e-15);
    EXPECT_LT(worst_speed, 2.5e-15);
    EXPECT_LT(worst_number, 3e-15);
    RecordProperty("worst_omega", std::to_string(worst_omega * 1e16) + "e-16");
    RecordProperty("worst_speed", std::to_string(worst_speed * 1e16) + "e-16");
    RecordProperty("worst_number", std::to_string(worst_number * 1e16) + "e-16");
}

TEST(Dispersion, TinyDepthsInWavelengthsAreTheShallowLimit) {
    // k D = 1e-6: sqrt(g D), of no dispersion, to the next term of the series (k D)²/6.
    const double shallow = std::sqrt(gravity * 0.01);
    EXPECT_NEAR(wave_omega(1e-4, 0.01) / 1e-4, shallow, 1e-12);
    EXPECT_NEAR(group_speed_at(1e-4, 0.01), shallow, 1e-11);
    EXPECT_NEAR(wave_number_at(1e-4 * shallow, 0.01), 1e-4, 1e-16);
}

TEST(Dispersion, DeepWaterIsTheLimitOfDepth) {
    for (const double k : between(smallest_wave_number, largest_wave_number, 40)) {
        EXPECT_EQ(wave_omega(k, deep_water), deep_omega(k));
        EXPECT_EQ(wave_number_at(deep_omega(k), deep_water), deep_wave_number(deep_omega(k)));
    }
    // Gravity waves' group speed is g / 2ω.
    EXPECT_NEAR(group_speed_at(deep_wave_number(0.6), deep_water), gravity / 1.2, 1e-3);
    // Half the phase speed for gravity, three halves for surface tension.
    EXPECT_NEAR(group_speed_at(3000.0, deep_water) * 3000.0 / deep_omega(3000.0), 1.5, 0.02);
}

TEST(Dispersion, AQuantisedWaveTakesItsDepthsFrequency) {
    for (const double depth : {1.0, 8.0, 60.0, 4000.0})
        for (const double wavelength : {2.0, 30.0, 200.0, 1000.0}) {
            const QuantisedVector k = quantise(2.0 * pi / wavelength, heading_vector(77.0));
            const Digits units =
                sqrt(exact_square(Digits(wave_number_of(k)), Digits(depth))) /
                (2 * Digits("3.14159265358979323846264338327950288419716939937510582") * 1000000) *
                pow(Digits(2), 64);
            EXPECT_LE(std::abs(static_cast<double>(Digits(quantised_omega(k, depth)) - units)), 1.0)
                << wavelength << " m over " << depth << " m";
        }
}

}  // namespace
}  // namespace trochoid
