// Row B12: seen from the air, the sea of a wind does not repeat itself.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "protocol/model/sea.hpp"
#include "protocol/units/lattice.hpp"
#include "server/world/train_spectrum.hpp"

namespace trochoid {
namespace {

constexpr int side = 512;           // samples
constexpr double step_m = 16.0;     // between them: 8 km in all
constexpr int farthest = side / 2;  // lag, samples
constexpr int repeats_from = 25;    // samples: 400 m, about four of the longest waves

/// Heights of an unlimited sea of these trains over a square of 8 km.
std::vector<float> heights_of(const std::vector<WaveTrain>& trains) {
    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    box.begin = {-sea_time_bound};
    box.trains = trains;
    const SeaInstant sea(Sea({prepare(box, {})}), SeaTime{1'000'000});
    std::vector<float> heights;
    heights.reserve(size_t{side} * side);
    for (int z = 0; z < side; ++z)
        for (int x = 0; x < side; ++x)
            heights.push_back(sea.evaluate({to_lattice(x * step_m), to_lattice(z * step_m)}).ay);
    return heights;
}

/// Likeness of the picture and itself at a lag, -1 to 1, over a quarter of the samples that both have, evenly.
double likeness(const std::vector<float>& heights, int lag_x, int lag_z) {
    double both = 0;
    double first = 0;
    double second = 0;
    constexpr int stride = 11;
    for (int z = 0; z < farthest; z += stride)
        for (int x = 0; x < farthest; x += stride) {
            // Lags towards the west start from the east.
            const int from = lag_x < 0 ? x + farthest : x;
            const auto a = static_cast<double>(heights[static_cast<size_t>(z * side + from)]);
            const auto b =
                static_cast<double>(heights[static_cast<size_t>((z + lag_z) * side + from + lag_x)]);
            both += a * b;
            first += a * a;
            second += b * b;
        }
    return both / std::sqrt(first * second);
}

/// The greatest likeness at any lag that one would take for a repetition.
double strongest_repeat(const std::vector<float>& heights) {
    double strongest = 0;
    for (int z = 0; z < farthest; ++z)
        for (int x = -farthest + 1; x < farthest; ++x)
            if (std::max(std::abs(x), z) >= repeats_from)
                strongest = std::max(strongest, likeness(heights, x, z));
    return strongest;
}

std::vector<WaveTrain> sixty_trains(float speed, uint64_t seed) {
    StartWind wind;
    wind.speed = speed;
    wind.towards_degrees = 120.0F;
    wind.fetch = wind.width = to_lattice(400'000.0);
    wind.trains = 60;
    wind.seed = seed;
    return wind_trains(wind);
}

TEST(Repetition, NoneOfASeaOfSixtyTrains) {
    for (const uint64_t seed : {1ULL, 2ULL, 3ULL}) {
        const double strongest = strongest_repeat(heights_of(sixty_trains(12.0F, seed)));
        fmt::print("60 trains, seed {}: no lag from 400 m to 4 km is more alike than {:.2f}\n", seed,
                   strongest);
        EXPECT_LT(strongest, 0.6);
    }
}

/// Shows that the test above can fail: the same waves on the grid of a tile of 512 m, as a Fourier transform has them.
TEST(Repetition, ATileWouldBeSeen) {
    std::vector<WaveTrain> trains = sixty_trains(12.0F, 1);
    constexpr double a_tile = 8'192.0;  // turns, Q0.32, that 2^19 lattice units make one of
    for (WaveTrain& train : trains) {
        train.kx = static_cast<int32_t>(std::lround(train.kx / a_tile) * 8'192);
        train.kz = static_cast<int32_t>(std::lround(train.kz / a_tile) * 8'192);
        if (train.kx == 0 && train.kz == 0) train.kx = 8'192;
    }
    EXPECT_GT(strongest_repeat(heights_of(trains)), 0.99);
}

}  // namespace
}  // namespace trochoid
