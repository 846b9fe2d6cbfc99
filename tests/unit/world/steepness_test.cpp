#include "server/world/steepness.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "protocol/units/hash.hpp"
#include "server/world/box_steering.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/ship_box.hpp"
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
        limit_steepness(box, growth, SteepCrowd(others));
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
            const BoxPosition at = box_position(box, instant_of(box, box.begin), p);
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
    limit_steepness(first, 1.5, SteepCrowd());
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
    limit_steepness(second_box, 1.5, SteepCrowd(others));
    EXPECT_NEAR(steepness_of(second_box) * 1.5, 0.6 * (0.8 - 0.48), 1e-5);
}

TEST(Steepness, AGentleBoxIsLeftAlone) {
    WaveTrainBox box = random_wind(3, 1);
    for (WaveTrain& train : box.trains) train.choppiness = 0.01F;
    const WaveTrainBox before = box;
    limit_steepness(box, 1.5, SteepCrowd());
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
                const BoxPosition at = box_position(b, instant_of(b, b.begin), p);
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

/// A ship's box that sails east from (x, z) metres.
WaveTrainBox ship_at(double x, double z, float towards, SeaTime begin, uint32_t id) {
    StartShip ship;
    ship.at = {to_lattice(x), to_lattice(z)};
    ship.towards_degrees = towards;
    ship.speed = 5.0F;
    auto box = box_of(ship, begin, {{id}, {id * 64}});
    EXPECT_TRUE(box);
    return *box;
}

// Against a slow obvious twin: both boxes at every few seconds, corner by corner.
TEST(Steepness, MovingBoxesOverlapOnlyWhereTheyMeet) {
    int meetings = 0;
    int misses = 0;
    for (uint64_t i = 1; i <= 150; ++i) {
        const WaveTrainBox a = ship_at(0.0, 0.0, 90.0F, {0}, 1);
        WaveTrainBox b = ship_at(drawn(i, 1, -2500.0, 5000.0), drawn(i, 2, -2500.0, 2500.0),
                                 static_cast<float>(drawn(i, 3, 0.0, 359.0)), {0}, 2);
        b.end = b.begin + 1000 * second;
        b.decay_us = 10 * second;
        bool meet = false;
        for (int64_t s = 0; s < 1010 && !meet; s += 5)
            for (int64_t u = 0; u <= 20 && !meet; ++u)
                for (int64_t v = 0; v <= 20; ++v) {
                    const LatticePoint corner = instant_of(a, {s * second}).origin;
                    const int64_t au = a.length * u / 20, av = a.width * v / 20;
                    const LatticePoint p{corner.x + ((au * a.ux - av * a.uz) >> 30),
                                         corner.z + ((au * a.uz + av * a.ux) >> 30)};
                    const BoxPosition at = box_position(b, instant_of(b, {s * second}), p);
                    meet = meet ||
                           (at.in_reach && at.u >= 0 && at.u <= b.length && at.v >= 0 && at.v <= b.width);
                }
        EXPECT_EQ(may_overlap(a, b), may_overlap(b, a));
        if (meet) {
            EXPECT_TRUE(may_overlap(a, b)) << i;
        }
        meetings += meet ? 1 : 0;
        misses += may_overlap(a, b) ? 0 : 1;
    }
    EXPECT_GT(meetings, 10);
    EXPECT_GT(misses, 10) << "everything counts as overlapping";
}

TEST(Steepness, ShipsThatPassAtAnotherTimeDoNotMeet) {
    const WaveTrainBox west = ship_at(-4000.0, 0.0, 90.0F, {0}, 1);
    EXPECT_TRUE(may_overlap(west, ship_at(0.0, 0.0, 270.0F, {0}, 2))) << "head on";
    EXPECT_FALSE(may_overlap(west, ship_at(0.0, 0.0, 90.0F, {0}, 2))) << "one behind the other, equally fast";
    EXPECT_FALSE(may_overlap(west, ship_at(0.0, 6000.0, 90.0F, {0}, 2))) << "side by side";
}

/// A storm of 400 s that is steered at most at the fastest, and a box as large `east` metres beside it.
WaveTrainBox short_storm(uint32_t id, double east) {
    WaveTrainBox storm = random_wind(1, id);
    storm.origin = {to_lattice(east), 0};
    storm.begin = {0};
    storm.end = {300 * second};
    storm.decay_us = 100 * second;
    return storm;
}

TEST(Steepness, AWindThatMayBeSteeredCountsAsFarAsItCanGo) {
    WaveTrainBox storm = short_storm(1, 0.0);
    storm.course = {{storm.begin, 1000 * second, storm.origin, 10000, 0}};
    // 400 s at 100 m/s are 40 km; the two boxes' sides add 13 km at most.
    EXPECT_TRUE(may_overlap(storm, short_storm(2, 39'000.0), {0}));
    EXPECT_TRUE(may_overlap(storm, short_storm(2, -39'000.0), {0})) << "it may turn round";
    EXPECT_FALSE(may_overlap(storm, short_storm(2, 80'000.0), {0}));
    WaveTrainBox later = short_storm(2, 0.0);
    later.begin = storm.end + storm.decay_us;
    later.end = later.begin + second;
    EXPECT_FALSE(may_overlap(storm, later, {0})) << "but only while it lasts";
    // Two storms come towards each other.
    WaveTrainBox other = short_storm(2, 75'000.0);
    EXPECT_FALSE(may_overlap(storm, other, {0}));
    other.course = {{other.begin, 1000 * second, other.origin, 0, 0}};
    EXPECT_TRUE(may_overlap(storm, other, {0}));
    EXPECT_EQ(may_overlap(other, storm, {0}), may_overlap(storm, other, {0}));
    // What has been sailed is settled: of 400 s a quarter is left.
    EXPECT_TRUE(may_overlap(storm, short_storm(2, 30'000.0), {0}));
    EXPECT_FALSE(may_overlap(storm, short_storm(2, 30'000.0), {300 * second}));
    EXPECT_FALSE(may_overlap(storm, short_storm(2, 39'000.0))) << "nothing will change any more";
    // A box that begins late finds a storm that may have been steered long before.
    WaveTrainBox late = short_storm(2, 35'000.0);
    late.begin = {390 * second};
    late.end = {2000 * second};
    EXPECT_TRUE(may_overlap(storm, late, {0}));
    EXPECT_FALSE(may_overlap(storm, late, {395 * second}));
    // One without end can come everywhere.
    storm.end = late.end = end_of_time;
    late.origin = {world_bound / 2, world_bound / 2};
    EXPECT_TRUE(may_overlap(storm, late, {0}));
}

// However a storm is steered from a settled moment on, the guard has counted with it.
TEST(Steepness, NoCourseThatIsSteeredLeavesTheReach) {
    int meetings = 0;
    int misses = 0;
    for (uint64_t i = 1; i <= 300; ++i) {
        WaveTrainBox storm = short_storm(1, 0.0);
        storm.course = {{storm.begin, 1000 * second, storm.origin, 100'000, 50'000}};
        const WaveTrainBox planned = storm;
        const SeaTime settled{static_cast<int64_t>(drawn(i, 1, 0.0, 380.0)) * second};
        const WaveTrainBox other = short_storm(2, drawn(i, 2, -60'000.0, 60'000.0));
        const auto leg = next_leg(storm, settled, drawn(i, 3, 0.0, 359.0), drawn(i, 4, 50.0, 100.0));
        ASSERT_TRUE(leg);
        steer(storm, *leg);
        if (may_overlap(storm, other)) {
            EXPECT_TRUE(may_overlap(planned, other, settled)) << i;
            ++meetings;
        }
        misses += may_overlap(planned, other, settled) ? 0 : 1;
    }
    EXPECT_GT(meetings, 20);
    EXPECT_GT(misses, 20) << "everything counts as overlapping";
}

TEST(Steepness, RoundAndIrregularWavesCountForWhatTheyAdd) {
    WaveTrainBox box = random_wind(4, 1);
    box.trains.resize(1);
    const QuantisedVector along =
        quantise(0.1, {static_cast<double>(box.ux) * 0x1p-30, static_cast<double>(box.uz) * 0x1p-30});
    box.trains[0].kx = along.kx;
    box.trains[0].kz = along.kz;
    const double plain = steepness_of(box);
    box.roundness = full_roundness;
    EXPECT_NEAR(steepness_of(box), plain * std::sqrt(2.0), plain * 1e-4);
    box.roundness = full_roundness / 2;
    EXPECT_NEAR(steepness_of(box), plain * std::sqrt(1.25), plain * 1e-4);
    box.roundness = 0;
    box.irregular.share = full_irregularity / 4;
    EXPECT_NEAR(steepness_of(box), plain * 1.25, plain * 1e-6);
    // Across the box the phase's lean adds fully.
    box.irregular.share = 0;
    box.roundness = full_roundness;
    box.trains[0].kx = -along.kz;
    box.trains[0].kz = along.kx;
    EXPECT_NEAR(steepness_of(box), plain * 2.0, plain * 1e-4);
}

// No slope that the wake's own samples show is above what is counted, which is not far above either.
TEST(Steepness, AWakeIsNotSteeperThanCounted) {
    const WaveTrainBox box = ship_at(0.0, 0.0, 0.0F, {0}, 1);
    double steepest = 0.0;
    const auto add = [&](const WakeWave& wave, float amplitude) {
        return static_cast<double>(amplitude) * static_cast<double>(wave.gain) * 0x1p-24 *
               std::hypot(static_cast<double>(wave.ku), static_cast<double>(wave.kv));
    };
    constexpr int64_t far_behind = INT32_MAX;
    for (int64_t behind = 1; behind < 400; ++behind)
        for (int64_t aside = 0; aside <= behind * 2 / 5; ++aside) {
            const WakeSample s = wake_at(box.wake, behind * 512, aside * 512, far_behind, 0);
            steepest = std::max(
                steepest, add(s.transverse, box.wake.transverse) + add(s.diverging, box.wake.diverging));
        }
    EXPECT_LE(steepest, steepness_of(box));
    EXPECT_GT(steepest, 0.4 * steepness_of(box));
    WaveTrainBox limited = box;
    limit_steepness(limited, 1.0, SteepCrowd());
    EXPECT_LE(steepness_of(limited), 0.48);
    EXPECT_EQ(limited.wake.transverse, box.wake.transverse);
}

TEST(Steepness, ASuccessorIsNotCountedAgainstItsPredecessor) {
    WaveTrainBox old = random_wind(7, 1);
    limit_steepness(old, 1.0, SteepCrowd());
    WaveTrainBox next = old;
    next.id = {2};
    WaveTrainBox unchanged = next;
    const SteepBox only_old[] = {{&old, 1.0}};
    limit_successor(next, {1}, 1.0, SteepCrowd(only_old));
    EXPECT_EQ(next, unchanged);
    limit_steepness(unchanged, 1.0, SteepCrowd(only_old));
    EXPECT_LT(steepness_of(unchanged), 0.5 * steepness_of(next)) << "a stranger would be";
    // A third box counts the two as one.
    const SteepBox both[] = {{&old, 1.0}, {&next, 1.0, {1}}};
    WaveTrainBox third = random_wind(7, 3);
    limit_steepness(third, 1.0, SteepCrowd(both));
    EXPECT_NEAR(steepness_of(third), 0.6 * (0.8 - steepness_of(old)), 1e-5);
}

}  // namespace
}  // namespace trochoid
