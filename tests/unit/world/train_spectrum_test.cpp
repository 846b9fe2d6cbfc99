#include "server/world/train_spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "server/world/dispersion.hpp"

namespace trochoid {
namespace {

const WindSea developed = wind_sea(14.0, 400'000 * lattice_per_metre);

double omega_of(const WaveTrain& train) {
    return static_cast<double>(train.omega) * 0x1p-64 * 2.0 * pi * 1e6;
}

double heading_of(const WaveTrain& train) { return std::atan2(train.kx, -train.kz) * 180.0 / pi; }

TEST(TrainSpectrum, EnergyIsTheWindsForAnyNumberOfTrains) {
    for (uint16_t count = 2; count <= 64; ++count) {
        double sum = 0.0;
        const auto trains = wind_trains(developed, 70.0, count, 5);
        ASSERT_EQ(trains.size(), count);
        for (const WaveTrain& train : trains) sum += 0.5 * std::pow(static_cast<double>(train.amplitude), 2);
        const double h = developed.significant_height;
        EXPECT_NEAR(sum, h * h / 16.0, 1e-6 * h * h) << count;
        EXPECT_NEAR(significant_height(trains), h, 1e-6 * h) << count;
    }
    const auto alone = wind_trains(developed, 70.0, 1, 5);
    EXPECT_FLOAT_EQ(alone.at(0).amplitude, static_cast<float>(developed.significant_height / 2.0));
    EXPECT_NEAR(omega_of(alone[0]), developed.peak_omega, 1e-4 * developed.peak_omega);
    EXPECT_NEAR(significant_height(alone), developed.significant_height, 1e-6);
}

TEST(TrainSpectrum, QuantileInvertsTheIntegratedPiersonMoskowitzSpectrum) {
    const double peak = developed.peak_omega;
    // The spectrum itself, S ~ ω^-5 exp(-5/4 (ωp/ω)^4), summed with a fine step: no shared closed form.
    double sum = 0.0;
    const double step = peak * 1e-4;
    std::vector<double> cumulative;
    for (double w = 0.2 * peak; w < 40.0 * peak; w += step) {
        sum += std::pow(w / peak, -5.0) * std::exp(-1.25 * std::pow(peak / w, 4.0));
        cumulative.push_back(sum);
    }
    for (double q : {0.01, 0.1, 0.2865, 0.5, 0.9, 0.99}) {
        const auto at = std::lower_bound(cumulative.begin(), cumulative.end(), q * sum) - cumulative.begin();
        const double w = 0.2 * peak + static_cast<double>(at) * step;
        EXPECT_NEAR(energy_quantile(peak, q), w, 2e-3 * w) << q;
        const double closed = peak * std::pow(1.25 / -std::log(q), 0.25);
        EXPECT_NEAR(energy_quantile(peak, q), closed, 1e-14 * closed) << q;
    }
}

TEST(TrainSpectrum, OneTrainLiesInTheMiddleHalfOfEachStratum) {
    for (uint64_t seed : {1ULL, 2ULL, 77ULL})
        for (const uint16_t count : {uint16_t{2}, uint16_t{16}, uint16_t{64}}) {
            const auto trains = wind_trains(developed, 200.0, count, seed);
            for (size_t i = 0; i < trains.size(); ++i) {
                const double w = omega_of(trains[i]);
                const double q = std::exp(-1.25 * std::pow(developed.peak_omega / w, 4.0)) * count -
                                 static_cast<double>(i);
                // Quantisation moves a long wave's frequency by up to one part in 10^4.
                EXPECT_GT(q, 0.25 - 0.01 * count / 16.0) << seed << ", train " << i;
                EXPECT_LT(q, 0.75 + 0.01 * count / 16.0) << seed << ", train " << i;
            }
        }
}

TEST(TrainSpectrum, WavelengthsFallAndFrequencyIsTheQuantisedVectors) {
    for (uint64_t seed = 1; seed < 20; ++seed) {
        const auto trains = wind_trains(developed, 33.0, 64, seed);
        for (size_t i = 0; i < trains.size(); ++i) {
            EXPECT_EQ(trains[i].omega, quantised_omega({trains[i].kx, trains[i].kz}));
            EXPECT_FLOAT_EQ(trains[i].choppiness, 1.0F);
            if (i > 0) {
                EXPECT_GE(wave_number_of({trains[i].kx, trains[i].kz}),
                          wave_number_of({trains[i - 1].kx, trains[i - 1].kz}));
            }
        }
    }
}

TEST(TrainSpectrum, DirectionsFollowACosineSquareAroundTheWind) {
    // The share of a cos² distribution below t, against a plain sum of the density.
    for (double q = 0.0; q <= 1.0; q += 0.0625) {
        const double t = spread_quantile(q);
        double below = 0.0;
        const int steps = 20000;
        for (int i = 0; i < steps; ++i) {
            const double at = -1.0 + (t + 1.0) * (i + 0.5) / steps;
            below += std::pow(std::cos(pi * at / 2.0), 2) * (t + 1.0) / steps;
        }
        EXPECT_NEAR(below, q, 1e-4) << "t = " << t;
    }
    double mean = 0.0;
    for (uint64_t seed = 1; seed <= 50; ++seed) {
        for (const WaveTrain& train : wind_trains(developed, 120.0, 32, seed)) {
            const double deviation = heading_of(train) - 120.0;
            mean += deviation / (50.0 * 32.0);
            EXPECT_LE(std::abs(deviation), spread_half_width(omega_of(train), developed.peak_omega) + 0.05);
        }
    }
    EXPECT_NEAR(mean, 0.0, 0.5);
    EXPECT_DOUBLE_EQ(spread_half_width(0.5, 1.0), 40.0);
    EXPECT_DOUBLE_EQ(spread_half_width(1.5, 1.0), 50.0);
    EXPECT_DOUBLE_EQ(spread_half_width(3.0, 1.0), 60.0);
}

TEST(TrainSpectrum, SeedsReproduceAndDiffer) {
    EXPECT_EQ(wind_trains(developed, 10.0, 24, 42), wind_trains(developed, 10.0, 24, 42));
    const auto one = wind_trains(developed, 10.0, 24, 42);
    const auto other = wind_trains(developed, 10.0, 24, 43);
    std::set<uint32_t> phases;
    for (size_t i = 0; i < one.size(); ++i) {
        EXPECT_NE(one[i].phase, other[i].phase);
        EXPECT_TRUE(one[i].kx != other[i].kx || one[i].kz != other[i].kz);
        phases.insert(one[i].phase >> 24);
    }
    EXPECT_GT(phases.size(), 16U) << "phases cluster";
}

}  // namespace
}  // namespace trochoid
