#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/land/wave_bands.hpp"
#include "tests/unit/land/coasts.hpp"

namespace trochoid {
namespace {

double degrees_of(const WaveTrain& t) {
    return std::atan2(double(t.kz), double(t.kx)) * 180.0 / std::numbers::pi;
}
double wavelength_of(const WaveTrain& t) { return 0x1p22 / std::hypot(double(t.kx), double(t.kz)); }

TEST(WaveBands, EveryTrainIsInOneNarrowBand) {
    WaveTrainBox b = open_box(20.0);
    for (int i = 0; i < 200; ++i)
        b.trains.push_back(train(20.0 + 120.0 * ((i * 37 % 200) / 200.0 - 0.5), 5.0 + 2.3 * ((i * 71) % 200),
                                 0.1 + 0.001 * i));
    std::vector<int> seen(b.trains.size(), 0);
    size_t first_before = 0;
    const auto bands = wave_bands(b);
    EXPECT_GT(bands.size(), 8U);
    for (const WaveBand& band : bands) {
        double least_angle = 1e9, largest_angle = -1e9, least = 1e9, largest = 0.0;
        for (const size_t i : band.trains) {
            ++seen[i];
            least_angle = std::min(least_angle, degrees_of(b.trains[i]));
            largest_angle = std::max(largest_angle, degrees_of(b.trains[i]));
            least = std::min(least, wavelength_of(b.trains[i]));
            largest = std::max(largest, wavelength_of(b.trains[i]));
        }
        EXPECT_LE(largest_angle - least_angle, 15.001);
        EXPECT_LE(largest / least, 2.0);
        const double mean = std::atan2(band.dz, band.dx) * 180.0 / std::numbers::pi;
        EXPECT_GE(mean, least_angle - 1e-6);
        EXPECT_LE(mean, largest_angle + 1e-6);
        EXPECT_GE(1.0 / band.turns_per_metre, least * 0.999999);
        EXPECT_LE(1.0 / band.turns_per_metre, largest * 1.000001);
        EXPECT_NEAR(band.dx * band.dx + band.dz * band.dz, 1.0, 1e-14);
        EXPECT_TRUE(band.trains.front() >= first_before);
        first_before = band.trains.front();
    }
    for (const int n : seen) EXPECT_EQ(n, 1);
}

TEST(WaveBands, MeansAreWeightedByEnergy) {
    WaveTrainBox b = open_box(0.0);
    b.trains = {train(2.0, 100.0, 2.0), train(-4.0, 80.0, 1.0)};
    const auto bands = wave_bands(b);
    ASSERT_EQ(bands.size(), 1U);
    EXPECT_NEAR(std::atan2(bands[0].dz, bands[0].dx) * 180.0 / std::numbers::pi, (4.0 * 2.0 - 4.0) / 5.0,
                0.01);
    EXPECT_NEAR(bands[0].turns_per_metre, (4.0 / 100.0 + 1.0 / 80.0) / 5.0, 1e-6);
    EXPECT_NEAR(bands[0].variance, 2.5, 1e-6);
    EXPECT_NEAR(significant_height(b), 4.0 * std::sqrt(2.5), 1e-6);
}

TEST(WaveBands, DirectionBinsFollowTheBox) {
    WaveTrainBox b = open_box(37.0);
    b.trains = {train(37.0 - 7.4, 100.0, 1.0), train(37.0 + 7.4, 100.0, 1.0), train(37.0 + 7.6, 100.0, 1.0)};
    const auto bands = wave_bands(b);
    ASSERT_EQ(bands.size(), 2U);
    EXPECT_EQ(bands[0].trains, (std::vector<size_t>{0, 1}));
}

TEST(WaveBands, TrainsThatHaveNotGrownHaveABandToo) {
    WaveTrainBox b = open_box(0.0);
    b.trains = {train(0.0, 100.0, 0.0)};
    const auto bands = wave_bands(b);
    ASSERT_EQ(bands.size(), 1U);
    EXPECT_NEAR(bands[0].dx, 1.0, 1e-9);
}

}  // namespace
}  // namespace trochoid
