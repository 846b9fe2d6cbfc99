#include "server/world/steepness.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "protocol/units/hash.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/wind_box.hpp"

namespace trochoid {
namespace {

constexpr int64_t second = microseconds_per_second;

/// A number in [least, most) drawn from (seed, index).
double drawn(uint64_t seed, uint64_t index, double least, double most) {
    return least + (most - least) * static_cast<double>(splitmix64(seed * 1000 + index) >> 11) * 0x1p-53;
}

WaveTrainBox random_wind(uint64_t seed, uint32_t id) {
    StartWind wind;
    wind.speed = static_cast<float>(drawn(seed, 1, 3.0, 25.0));
    wind.towards_degrees = static_cast<float>(drawn(seed, 2, 0.0, 359.0));
    wind.origin = {to_lattice(drawn(seed, 3, -6000.0, 6000.0)), to_lattice(drawn(seed, 4, -6000.0, 6000.0))};
    wind.fetch = to_lattice(drawn(seed, 5, 500.0, 8000.0));
    wind.width = to_lattice(drawn(seed, 6, 500.0, 5000.0));
    wind.life_us = static_cast<int64_t>(drawn(seed, 7, 1000.0, 9000.0)) * second;
    wind.trains = static_cast<uint16_t>(drawn(seed, 8, 4.0, 40.0));
    wind.seed = seed;
    return box_of(wind, {static_cast<int64_t>(drawn(seed, 9, 0.0, 3000.0)) * second}, {{id}, {id * 64}});
}

TEST(Steepness, StaysWithinTheLimitAtEveryPointAndTime) {
    constexpr double growth = 1.5;
    std::vector<WaveTrainBox> boxes;
    for (uint32_t i = 1; i <= 40; ++i) {
        WaveTrainBox box = random_wind(i, i);
        std::vector<SteepBox> others;
        for (const WaveTrainBox& other : boxes) others.push_back({&other, growth});
        limit_steepness(box, growth, others);
        boxes.push_back(std::move(box));
    }
    double largest = 0.0;
    int crowded = 0;
    for (uint64_t i = 0; i < 4000; ++i) {
        const LatticePoint p{to_lattice(drawn(i, 11, -12000.0, 12000.0)),
                             to_lattice(drawn(i, 12, -12000.0, 12000.0))};
        const SeaTime t{static_cast<int64_t>(drawn(i, 13, 0.0, 5000.0)) * second};
        double sum = 0.0;
        int here = 0;
        for (const WaveTrainBox& box : boxes) {
            const BoxPosition at = box_position(box, p);
            if (at.u < 0 || at.u > box.length || at.v < 0 || at.v > box.width || !alive(box, t, t + 1))
                continue;
            for (const WaveTrain& train : box.trains)
                sum += growth * static_cast<double>(train.choppiness) * static_cast<double>(train.amplitude) *
                       wave_number_of({train.kx, train.kz});
            ++here;
        }
        EXPECT_LE(sum, 0.8);
        largest = std::max(largest, sum);
        crowded += here >= 3 ? 1 : 0;
    }
    EXPECT_GT(crowded, 100) << "the winds hardly overlap: nothing was tested";
    EXPECT_GT(largest, 0.5);
}

TEST(Steepness, ScalesChoppinessAloneAndLeavesRoom) {
    const WaveTrainBox before = random_wind(7, 1);
    WaveTrainBox first = before;
    limit_steepness(first, 1.5, {});
    EXPECT_LE(steepness_of(first) * 1.5, 0.8 * 0.6);
    EXPECT_GT(steepness_of(first) * 1.5, 0.8 * 0.6 * 0.9999);
    for (size_t i = 0; i < first.trains.size(); ++i) {
        EXPECT_LT(first.trains[i].choppiness, before.trains[i].choppiness);
        EXPECT_EQ(first.trains[i].choppiness, first.trains[0].choppiness);
        WaveTrain same = first.trains[i];
        same.choppiness = before.trains[i].choppiness;
        EXPECT_EQ(same, before.trains[i]);
    }
    // The next at the same place takes 60 % of the rest: 0.6 * (0.8 - 0.48).
    WaveTrainBox second_box = before;
    second_box.id = {2};
    const SteepBox others[] = {{&first, 1.5}};
    limit_steepness(second_box, 1.5, others);
    EXPECT_NEAR(steepness_of(second_box) * 1.5, 0.6 * (0.8 - 0.48), 1e-5);
}

TEST(Steepness, AGentleBoxIsLeftAlone) {
    WaveTrainBox box = random_wind(3, 1);
    for (WaveTrain& train : box.trains) train.choppiness = 0.01F;
    const WaveTrainBox before = box;
    limit_steepness(box, 1.5, {});
    EXPECT_EQ(box, before);
}

TEST(Steepness, OverlapNeverMissesACommonPoint) {
    int together = 0;
    int apart = 0;
    for (uint64_t i = 1; i < 200; ++i) {
        const WaveTrainBox a = random_wind(2 * i, 1);
        const WaveTrainBox b = random_wind(2 * i + 1, 2);
        bool common = false;
        for (int64_t u = 0; u <= 24; ++u)
            for (int64_t v = 0; v <= 24; ++v) {
                const int64_t au = a.length * u / 24;
                const int64_t av = a.width * v / 24;
                const LatticePoint p{a.origin.x + ((au * a.ux - av * a.uz) >> 30),
                                     a.origin.z + ((au * a.uz + av * a.ux) >> 30)};
                const BoxPosition at = box_position(b, p);
                common = common || (at.u >= 0 && at.u <= b.length && at.v >= 0 && at.v <= b.width);
            }
        const bool same_time = a.begin < b.end + b.decay_us && b.begin < a.end + a.decay_us;
        EXPECT_EQ(may_overlap(a, b), may_overlap(b, a));
        if (common && same_time) {
            EXPECT_TRUE(may_overlap(a, b)) << i;
            ++together;
        }
        if (!may_overlap(a, b)) ++apart;
    }
    EXPECT_GT(together, 20);
    EXPECT_GT(apart, 20) << "everything counts as overlapping";
}

TEST(Steepness, UnlimitedSidesReachEverywhere) {
    WaveTrainBox everywhere = random_wind(1, 1);
    everywhere.length = everywhere.width = 0;
    WaveTrainBox far = random_wind(2, 2);
    far.origin = {world_bound / 2, -world_bound / 2};
    far.begin = everywhere.begin;
    EXPECT_TRUE(may_overlap(everywhere, far));
    EXPECT_FALSE(may_overlap(random_wind(1, 1), far));
}

}  // namespace
}  // namespace trochoid
