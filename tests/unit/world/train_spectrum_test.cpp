#include "server/world/train_spectrum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "protocol/units/lattice.hpp"
#include "server/world/direction_spread.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/spectrum.hpp"

namespace trochoid {
namespace {

StartWind gale(uint16_t trains, uint64_t seed = 5) {
    StartWind wind;
    wind.speed = 14.0F;
    wind.towards_degrees = 120.0F;
    wind.fetch = wind.width = to_lattice(400'000.0);
    wind.trains = trains;
    wind.seed = seed;
    return wind;
}

FrequencySpectrum spectrum_of(const StartWind& wind) {
    return wind_spectrum(static_cast<double>(wind.speed), wind.fetch, wind.spectrum);
}

double omega_of(const WaveTrain& train) {
    return static_cast<double>(train.omega) * 0x1p-64 * 2.0 * pi * 1e6;
}

double deviation_of(const WaveTrain& train, const StartWind& wind) {
    return std::atan2(train.kx, -train.kz) * 180.0 / pi - static_cast<double>(wind.towards_degrees);
}

TEST(TrainSpectrum, HeightIsTheSpectrumsForEverySpectrumAndNumberOfTrains) {
    for (const Spectrum kind :
         {Spectrum::automatic, Spectrum::pierson_moskowitz, Spectrum::jonswap, Spectrum::neumann})
        for (const double fetch : {500.0, 80'000.0, 1'000'000.0})
            for (const float speed : {1.0F, 12.0F, 40.0F})
                for (const uint16_t count : std::initializer_list<uint16_t>{1, 2, 7, 64, 256}) {
                    StartWind wind = gale(count);
                    wind.spectrum = kind;
                    wind.fetch = to_lattice(fetch);
                    wind.speed = speed;
                    const auto trains = wind_trains(wind);
                    ASSERT_EQ(trains.size(), count);
                    const double h = spectrum_of(wind).significant_height();
                    EXPECT_NEAR(significant_height(trains), h, 1e-7 * h) << count;
                    for (const WaveTrain& train : trains) EXPECT_TRUE(validate(train));
                }
}

TEST(TrainSpectrum, OneTrainLiesAtThePeakWithTheSpectrumsEnergy) {
    const StartWind wind = gale(1);
    const auto alone = wind_trains(wind);
    const FrequencySpectrum spectrum = spectrum_of(wind);
    EXPECT_NEAR(omega_of(alone.at(0)), spectrum.peak_omega(), 1e-4 * spectrum.peak_omega());
    EXPECT_NEAR(deviation_of(alone[0], wind), 0.0, 0.01);
    // As a regular wave it is Hs / √2 high.
    EXPECT_NEAR(2.0 * static_cast<double>(alone[0].amplitude), spectrum.significant_height() / std::sqrt(2.0),
                1e-6);
}

TEST(TrainSpectrum, OneTrainLiesInTheMiddleHalfOfEachStratum) {
    for (uint64_t seed : {1ULL, 2ULL, 77ULL})
        for (const uint16_t count : {uint16_t{2}, uint16_t{16}, uint16_t{64}}) {
            const StartWind wind = gale(count, seed);
            const FrequencySpectrum spectrum = spectrum_of(wind);
            const auto trains = wind_trains(wind);
            for (size_t i = 0; i < trains.size(); ++i) {
                const double q =
                    spectrum.cumulative(omega_of(trains[i])) / spectrum.m0() * count - static_cast<double>(i);
                // Quantisation moves a long wave's frequency by up to one part in 10^4.
                EXPECT_GT(q, 0.25 - 0.01 * count / 16.0) << seed << ", train " << i;
                EXPECT_LT(q, 0.75 + 0.01 * count / 16.0) << seed << ", train " << i;
            }
        }
}

TEST(TrainSpectrum, PartitionIsPaperCsWithItsPrefactorMended) {
    // M = 16 frequencies of n = 5 directions: energy m0 / (M n) each, ζ = √(2 E / (M n)).
    StartWind wind = gale(80);
    wind.directions = 5;
    wind.spectrum = Spectrum::pierson_moskowitz;
    const FrequencySpectrum spectrum = spectrum_of(wind);
    const auto trains = wind_trains(wind);
    ASSERT_EQ(trains.size(), 80U);
    // In the paper's letters S = A ω^-5 exp(-B ω^-4): A = α g², and ζ = √(A / (2 B M n)) where nothing is cut off.
    const double a = 0.0081 * gravity * gravity;
    const double b = 0.74 * std::pow(gravity / 14.0, 4.0);
    const double zeta = std::sqrt(a / (2.0 * b * 80.0));
    std::vector<double> shares;
    for (const WaveTrain& train : trains) {
        EXPECT_EQ(train.amplitude, trains[0].amplitude);
        EXPECT_NEAR(static_cast<double>(train.amplitude), zeta, 1e-3 * zeta);
        shares.push_back(spectrum.cumulative(omega_of(train)) / spectrum.m0() * 16.0);
    }
    for (size_t i = 0; i < 16; ++i) {
        std::vector<double> places;
        const DirectionSpread spread(wind.spreading, omega_of(trains[5 * i]), spectrum.peak_omega(),
                                     wind_at_height(14.0, 10.0));
        for (size_t j = 0; j < 5; ++j) {
            // One frequency for the five, in stratum i ...
            EXPECT_NEAR(shares[5 * i + j], shares[5 * i], 0.02) << i;
            EXPECT_NEAR(shares[5 * i + j], static_cast<double>(i) + 0.5, 0.27) << i;
            places.push_back(5.0 * spread.cumulative(deviation_of(trains[5 * i + j], wind)));
        }
        // ... and one direction in each fifth of the spreading.
        std::sort(places.begin(), places.end());
        for (size_t j = 0; j < 5; ++j) {
            EXPECT_GT(places[j], static_cast<double>(j) - 0.01) << i;
            EXPECT_LT(places[j], static_cast<double>(j) + 1.01) << i;
        }
    }
}

TEST(TrainSpectrum, WavelengthsFallAndFrequencyIsTheQuantisedVectorsAtItsDepth) {
    for (const float depth : {0.0F, 4.0F, 25.0F, 4000.0F})
        for (uint64_t seed = 1; seed < 6; ++seed) {
            StartWind wind = gale(64, seed);
            wind.reference_depth = depth;
            EXPECT_EQ(reference_depth_of(wind), depth == 0.0F ? deep_water : static_cast<double>(depth));
            const auto trains = wind_trains(wind);
            for (size_t i = 0; i < trains.size(); ++i) {
                const QuantisedVector k{trains[i].kx, trains[i].kz};
                EXPECT_EQ(trains[i].omega, quantised_omega(k, reference_depth_of(wind)));
                EXPECT_EQ(trains[i].choppiness, 1.0F);
                if (i > 0) {
                    EXPECT_GE(wave_number_of(k), wave_number_of({trains[i - 1].kx, trains[i - 1].kz}));
                }
            }
        }
    // The same frequencies, but shorter waves where the reference is shallow.
    StartWind shallow = gale(16);
    shallow.reference_depth = 5.0F;
    const auto deep = wind_trains(gale(16));
    const auto near = wind_trains(shallow);
    EXPECT_NEAR(omega_of(near[0]), omega_of(deep[0]), 2e-4 * omega_of(deep[0]));
    EXPECT_GT(wave_number_of({near[0].kx, near[0].kz}), 1.8 * wave_number_of({deep[0].kx, deep[0].kz}));
}

TEST(TrainSpectrum, DirectionsFollowTheSpreading) {
    for (const Spreading kind : {Spreading::cosine_squared, Spreading::hasselmann})
        for (const uint16_t directions : std::initializer_list<uint16_t>{0, 1, 4}) {
            double mean = 0.0;
            double square = 0.0;
            double expected = 0.0;
            for (uint64_t seed = 1; seed <= 50; ++seed) {
                StartWind wind = gale(32, seed);
                wind.spreading = kind;
                wind.directions = directions;
                const FrequencySpectrum spectrum = spectrum_of(wind);
                for (const WaveTrain& train : wind_trains(wind)) {
                    const double deviation = deviation_of(train, wind);
                    EXPECT_LE(std::abs(deviation), 60.01);
                    mean += deviation / (50.0 * 32.0);
                    square += deviation * deviation / (50.0 * 32.0);
                    const DirectionSpread spread(kind, omega_of(train), spectrum.peak_omega(),
                                                 wind_at_height(14.0, 10.0));
                    for (double at = -59.0; at < 60.0; at += 2.0)
                        expected += at * at * spread.density(at) * 2.0 / (50.0 * 32.0);
                }
            }
            // 1600 draws of 25 to 30 degrees each.
            EXPECT_NEAR(mean, 0.0, 2.0) << directions;
            EXPECT_NEAR(square, expected, 0.08 * expected) << directions;
        }
}

TEST(TrainSpectrum, SeedsReproduceAndDiffer) {
    for (const uint16_t directions : std::initializer_list<uint16_t>{0, 4}) {
        StartWind wind = gale(24, 42);
        wind.directions = directions;
        const auto one = wind_trains(wind);
        EXPECT_EQ(one, wind_trains(wind));
        wind.seed = 43;
        const auto other = wind_trains(wind);
        std::set<uint32_t> phases;
        for (size_t i = 0; i < one.size(); ++i) {
            EXPECT_NE(one[i].phase, other[i].phase);
            EXPECT_TRUE(one[i].kx != other[i].kx || one[i].kz != other[i].kz);
            phases.insert(one[i].phase >> 24);
        }
        EXPECT_GT(phases.size(), 16U) << "phases cluster";
    }
}

}  // namespace
}  // namespace trochoid
