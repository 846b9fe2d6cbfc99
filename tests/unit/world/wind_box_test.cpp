#include "server/world/wind_box.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "protocol/model/interest_state.hpp"
#include "server/event/wind_limits.hpp"
#include "server/world/box_effects.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/wind_sea.hpp"

namespace trochoid {
namespace {

constexpr int64_t second = microseconds_per_second;

StartWind breeze() {
    StartWind wind;
    wind.speed = 9.0F;
    wind.towards_degrees = 60.0F;
    wind.origin = {to_lattice(-500.0), to_lattice(1200.0)};
    wind.fetch = to_lattice(6000.0);
    wind.width = to_lattice(2500.0);
    wind.life_us = 7200 * second;
    wind.trains = 12;
    wind.seed = 3;
    return wind;
}

const NewIds ids{{4}, {31}};

TEST(WindBox, IsTheSameOnEveryMachine) {
    // The value that x86-64, aarch64 and s390x gave. Logs carry the quantised box, so another value would only change
    // new winds; but it has to be one value everywhere.
    EXPECT_EQ(hash_of(box_of(breeze(), {5 * second}, ids)), 12760845012639355464ULL);
}

TEST(WindBox, OriginIsTheMiddleOfTheRearEdge) {
    for (float heading : {0.0F, 60.0F, 90.0F, 200.0F, 345.5F}) {
        StartWind wind = breeze();
        wind.towards_degrees = heading;
        const WaveTrainBox box = box_of(wind, {}, ids);
        EXPECT_TRUE(validate(box));
        const BoxPosition rear = box_position(box, instant_of(box, box.begin), wind.origin);
        EXPECT_NEAR(static_cast<double>(rear.u), 0.0, 2.0) << heading;
        EXPECT_NEAR(static_cast<double>(rear.v), static_cast<double>(wind.width) / 2.0, 2.0) << heading;
        // 1 km ahead along the heading, then 100 m to the right of it.
        const double h = static_cast<double>(heading) * pi / 180.0;
        const LatticePoint ahead{wind.origin.x + to_lattice(1000.0 * std::sin(h) + 100.0 * std::cos(h)),
                                 wind.origin.z + to_lattice(-1000.0 * std::cos(h) + 100.0 * std::sin(h))};
        const BoxPosition at = box_position(box, instant_of(box, box.begin), ahead);
        EXPECT_NEAR(static_cast<double>(at.u), 1000.0 * 1024.0, 4.0) << heading;
        EXPECT_NEAR(static_cast<double>(at.v - rear.v), 100.0 * 1024.0, 4.0) << heading;
    }
}

TEST(WindBox, LeadingEdgeAdvancesAtTheGroupSpeed) {
    const WaveTrainBox box = box_of(breeze(), {5 * second}, ids);
    const WindSea sea = wind_sea(9.0, box.length);
    // Full relation: a slow sea's ripples feel surface tension.
    const double cg = group_speed_at(deep_wave_number(sea.peak_omega), deep_water);
    for (int64_t s : {1, 60, 600, 2000}) {
        const BoxInstant at = instant_of(box, {(5 + s) * second});
        EXPECT_NEAR(to_metres(at.front), cg * static_cast<double>(s),
                    0.01 + 1e-4 * cg * static_cast<double>(s))
            << s;
    }
    const auto crossing = static_cast<int64_t>(6000.0 / cg);
    EXPECT_LT(instant_of(box, {(5 + crossing - 2) * second}).front, box.length);
    EXPECT_EQ(instant_of(box, {(5 + crossing + 2) * second}).front, box.length);
}

TEST(WindBox, HeightsGrowStayAndDecayAsTheRecordSays) {
    const WaveTrainBox box = box_of(breeze(), {5 * second}, ids);
    const SeaTime begin{5 * second};
    EXPECT_EQ(box.begin, begin);
    EXPECT_EQ(box.end, begin + 7200 * second);
    EXPECT_GT(box.build_up_us, 10 * second);
    EXPECT_LE(box.build_up_us, 7200 * second);
    const auto gain = [&](SeaTime t) { return static_cast<double>(instant_of(box, t).time_gain) * 0x1p-24; };
    EXPECT_EQ(gain(begin - 1), 0.0);
    EXPECT_NEAR(gain(begin + box.build_up_us / 4), 0.25, 1e-6);
    EXPECT_EQ(gain(begin + box.build_up_us), 1.0);
    EXPECT_EQ(gain(box.end - 1), 1.0);
    EXPECT_NEAR(gain(box.end + box.decay_us / 2), 0.5, 1e-6);
    EXPECT_EQ(gain(box.end + box.decay_us), 0.0);

    // Sides: nothing at the edges, all in the middle, half way up each ramp in between.
    const BoxInstant grown = instant_of(box, box.end - 1);
    const auto place_gain = [&](int64_t u, int64_t v) {
        const LatticePoint p{box.origin.x + ((u * box.ux - v * box.uz) >> 30),
                             box.origin.z + ((u * box.uz + v * box.ux) >> 30)};
        return static_cast<double>(envelope_at(box, grown, p).gain) * 0x1p-24;
    };
    const int64_t middle_u = box.length / 2;
    const int64_t middle_v = box.width / 2;
    EXPECT_EQ(place_gain(middle_u, middle_v), 1.0);
    EXPECT_NEAR(place_gain(box.ramp_rear / 2, middle_v), 0.5, 1e-3);
    EXPECT_NEAR(place_gain(box.length - box.ramp_front / 2, middle_v), 0.5, 1e-3);
    EXPECT_NEAR(place_gain(middle_u, box.ramp_side / 2), 0.5, 1e-3);
    EXPECT_EQ(place_gain(-2, middle_v), 0.0);
    EXPECT_EQ(place_gain(middle_u, box.width + 2), 0.0);
}

TEST(WindBox, RampsSuitWavesAndBox) {
    for (float speed : {1.0F, 9.0F, 40.0F})
        for (double side : {32.0, 500.0, 20000.0, 900000.0}) {
            StartWind wind = breeze();
            wind.speed = speed;
            wind.fetch = wind.width = to_lattice(side);
            wind.origin = {};
            const WaveTrainBox box = box_of(wind, {}, ids);
            EXPECT_TRUE(validate(box)) << speed << " m/s, " << side << " m";
            const double length =
                2.0 * pi / deep_wave_number(wind_sea(static_cast<double>(speed), wind.fetch).peak_omega);
            EXPECT_NEAR(to_metres(box.ramp_rear), std::max(1.0, std::min(4.0 * length, 0.15 * side)), 0.01);
            EXPECT_EQ(box.ramp_front, box.ramp_rear);
        }
}

TEST(WindBox, AWindUntilStoppedHasNoEnd) {
    StartWind wind = breeze();
    wind.life_us = 0;
    EXPECT_EQ(box_of(wind, {}, ids).end, end_of_time);
}

TEST(WindBox, WindsOutOfRangeAreRefusedWithTheRange) {
    const auto refused = [](auto change, ErrorCode code, const char* says) {
        StartWind wind = breeze();
        change(wind);
        const auto result = validate(wind);
        ASSERT_FALSE(result) << says;
        EXPECT_EQ(result.error().code, code) << says;
        EXPECT_NE(result.error().message.find(says), std::string::npos) << result.error().message;
    };
    const ErrorCode range = ErrorCode::value_out_of_range;
    EXPECT_TRUE(validate(breeze()));
    refused([](StartWind& w) { w.speed = 0.9F; }, range, "give 1 to 40");
    refused([](StartWind& w) { w.speed = 41.0F; }, range, "give 1 to 40");
    refused([](StartWind& w) { w.speed = std::numeric_limits<float>::quiet_NaN(); }, range, "give 1 to 40");
    refused([](StartWind& w) { w.towards_degrees = 360.0F; }, range, "below 360");
    refused([](StartWind& w) { w.towards_degrees = -0.1F; }, range, "below 360");
    refused([](StartWind& w) { w.fetch = shortest_wind_side - 1; }, range, "fetch");
    refused([](StartWind& w) { w.fetch = longest_wind_side + 1; }, range, "fetch");
    refused([](StartWind& w) { w.width = 0; }, range, "width");
    refused([](StartWind& w) { w.life_us = 999'999; }, range, "life");
    refused([](StartWind& w) { w.life_us = -1; }, range, "life");
    refused([](StartWind& w) { w.trains = 0; }, ErrorCode::too_many_trains, "1 to 256");
    refused([](StartWind& w) { w.trains = 257; }, ErrorCode::too_many_trains, "1 to 256");
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinite = std::numeric_limits<float>::infinity();
    for (const float bad : {nan, infinite, -infinite, -3.0F, 100.0F})
        refused([bad](StartWind& w) { w.speed = bad; }, range, "give 1 to 40");
    for (const float bad : {nan, infinite, -0.5F})
        refused([bad](StartWind& w) { w.towards_degrees = bad; }, range, "below 360");
    refused([](StartWind& w) { w.fetch = 0; }, range, "the wind's fetch is 0 m: give 32 to 1048576");
    refused([](StartWind& w) { w.width = to_lattice(10e6); }, range, "is 10000000 m: give 32 to 1048576");
    refused([](StartWind& w) { w.fetch = INT64_MIN; }, range, "fetch");
    refused([](StartWind& w) { w.directions = 5; }, range, "divides the trains");
    refused([](StartWind& w) { w.directions = 13; }, range, "divides the trains");
    refused([](StartWind& w) { w.spectrum = static_cast<Spectrum>(4); }, range, "neumann (3)");
    refused([](StartWind& w) { w.spreading = static_cast<Spreading>(3); }, range, "hasselmann (2)");
    for (const float bad : {nan, infinite, -1.0F, 0.5F, 20000.0F})
        refused([bad](StartWind& w) { w.reference_depth = bad; }, range, "give 0 (deep) or 1 to 12000");
    for (const float bad : {nan, infinite, -0.01F, 1.01F}) {
        refused([bad](StartWind& w) { w.roundness = bad; }, range, "roundness");
        refused([bad](StartWind& w) { w.irregularity = bad; }, range, "irregularity");
    }
    for (const float bad : {nan, infinite, -0.01F, 1e-8F, 1.5F})
        refused([bad](StartWind& w) { w.noise = bad; }, range, "give 0 (none) or 9.5e-07 to 1");
    for (const float bad : {nan, infinite, -infinite, 101.0F, 1e30F}) {
        refused([bad](StartWind& w) { w.vx = bad; }, range, "give a speed of 0 to 100");
        refused([bad](StartWind& w) { w.vz = bad; }, range, "give a speed of 0 to 100");
    }
    refused([](StartWind& w) { w.vx = w.vz = 80.0F; }, range, "give a speed of 0 to 100");
    refused([](StartWind& w) { w.origin.x = world_bound + 1; }, range, "leaves the world");
    refused([](StartWind& w) { w.origin.x = world_bound - 10; }, range, "leaves the world");
    refused([](StartWind& w) { w.origin.z = INT64_MIN; }, range, "leaves the world");
}

TEST(WindBox, RoundnessNoiseAndGroupsAreTheWinds) {
    StartWind wind = breeze();
    const WaveTrainBox plain = box_of(wind, {}, ids);
    EXPECT_EQ(plain.roundness, 0);
    EXPECT_EQ(plain.irregular, IrregularHeight{});
    EXPECT_EQ(plain.noise, SurfaceNoise{});
    EXPECT_TRUE(plain.course.empty());

    wind.roundness = 1.0F;
    wind.irregularity = 0.5F;
    wind.noise = 0.02F;
    const WaveTrainBox box = box_of(wind, {}, ids);
    EXPECT_TRUE(validate(box));
    EXPECT_EQ(box.trains, plain.trains);
    EXPECT_EQ(box.roundness, full_roundness);
    EXPECT_EQ(box.irregular.share, full_irregularity / 2);
    // Groups: six dominant wavelengths along and across, at the dominant group speed.
    const double k = deep_wave_number(wind_sea(9.0, wind.fetch).peak_omega);
    const QuantisedVector along{box.irregular.ukx, box.irregular.ukz};
    const QuantisedVector across{box.irregular.vkx, box.irregular.vkz};
    EXPECT_NEAR(wave_number_of(along), k / 6.0, 1e-4 * k);
    EXPECT_NEAR(wave_number_of(across), k / 6.0, 1e-4 * k);
    EXPECT_NEAR(
        (1.0 * along.kx * box.ux + 1.0 * along.kz * box.uz) / (std::hypot(along.kx, along.kz) * 0x1p30), 1.0,
        1e-6);
    EXPECT_NEAR(
        (-1.0 * across.kx * box.uz + 1.0 * across.kz * box.ux) / (std::hypot(across.kx, across.kz) * 0x1p30),
        1.0, 1e-6);
    const double omega = static_cast<double>(box.irregular.omega) * 0x1p-64 * 2.0 * pi * 1e6;
    EXPECT_NEAR(omega / wave_number_of(along), group_speed_at(k, deep_water), 1e-9);
    EXPECT_EQ(box.noise.amplitude, 0.02F);
    EXPECT_EQ(box.noise.octaves, 3);
    EXPECT_TRUE(box.noise.displayed_only);
    EXPECT_TRUE(validate(box.noise));
    EXPECT_TRUE(validate(box.irregular));
    wind.seed = 4;
    EXPECT_NE(box_of(wind, {}, ids).noise.seed, box.noise.seed);
    EXPECT_NE(box_of(wind, {}, ids).irregular.phase_u, box.irregular.phase_u);
}

TEST(WindBox, LiteralHeightsAreThePapersFormula) {
    const LatticePoint corner{to_lattice(-300.0), to_lattice(77.0)};
    const double f = 0.05;
    const HeadingVector u = heading_vector(30.0);
    const IrregularHeight heights = literal_heights(0.4, u, 2.0 * pi, 2.0 * pi / f, corner);
    EXPECT_TRUE(validate(heights));
    for (const double t : {0.0, 1.3, 40.0})
        for (const double along : {0.0, 2.0, 31.0})
            for (const double across : {0.0, 15.0, 90.0}) {
                const LatticePoint p{corner.x + to_lattice(along * u.east - across * u.south),
                                     corner.z + to_lattice(along * u.south + across * u.east)};
                const IrregularPhases phases = phases_at_origin(heights, {seconds_to_us(t)});
                const HeightModulation m = modulation_at(heights, phases, p);
                const double expected = 1.0 - 0.4 * std::sin(t + along) * std::sin(across * f);
                EXPECT_NEAR(static_cast<double>(m.factor), expected, 1e-3)
                    << t << ", " << along << ", " << across;
            }
}

TEST(WindBox, AMovingWindsLegsFollowOnUntilItsEnd) {
    StartWind wind = breeze();
    wind.vx = 3.0F;
    wind.vz = -4.0F;
    const WaveTrainBox short_lived = box_of(wind, {5 * second}, ids);
    ASSERT_EQ(short_lived.course.size(), 1U);
    EXPECT_TRUE(validate(short_lived));
    EXPECT_EQ(short_lived.course[0].from, short_lived.begin);
    EXPECT_EQ(short_lived.course[0].origin, short_lived.origin);
    EXPECT_EQ(short_lived.course[0].from + short_lived.course[0].duration_us,
              short_lived.end + short_lived.decay_us);
    const LatticePoint after = corner_at(short_lived.course, {1005 * second});
    EXPECT_NEAR(to_metres(after.x - short_lived.origin.x), 3000.0, 0.2);
    EXPECT_NEAR(to_metres(after.z - short_lived.origin.z), -4000.0, 0.2);

    wind.vx = 1.5F;
    wind.vz = -2.0F;
    wind.life_us = 100LL * 86'400 * second;
    const WaveTrainBox long_lived = box_of(wind, {5 * second}, ids);
    ASSERT_EQ(long_lived.course.size(), 4U);
    EXPECT_TRUE(validate(long_lived));
    for (size_t i = 1; i < 4; ++i) {
        const CourseLeg& before = long_lived.course[i - 1];
        EXPECT_EQ(before.duration_us, longest_leg_us);
        EXPECT_EQ(long_lived.course[i].from, before.from + before.duration_us);
        EXPECT_EQ(long_lived.course[i].origin,
                  corner_at(std::span(long_lived.course).first(i), long_lived.course[i].from));
    }
    const LatticePoint last = corner_at(long_lived.course, long_lived.end);
    EXPECT_NEAR(to_metres(last.x - long_lived.origin.x), 1.5 * 100.0 * 86'400.0, 300.0);
}

TEST(WindBox, AMovingWindStopsAtTheWorldsEdgeOrAfterSixtyFourLegs) {
    StartWind wind = breeze();
    wind.life_us = 0;
    wind.vx = -100.0F;
    const WaveTrainBox fast = box_of(wind, {}, ids);
    EXPECT_TRUE(validate(fast));
    const LatticePoint edge = corner_at(fast.course, {longest_life_us});
    EXPECT_GT(edge.x, -world_bound);
    EXPECT_LT(edge.x, -world_bound + to_lattice(20'000.0));
    EXPECT_EQ(edge, corner_at(fast.course, {2 * longest_life_us}));

    wind.vx = 0.1F;
    const WaveTrainBox slow = box_of(wind, {}, ids);
    EXPECT_TRUE(validate(slow));
    EXPECT_EQ(slow.course.size(), most_course_legs);
    const LatticePoint still = corner_at(slow.course, {64 * longest_leg_us});
    EXPECT_EQ(still, corner_at(slow.course, {longest_life_us}));
    EXPECT_NEAR(to_metres(still.x - slow.origin.x), 0.1 * 64.0 * 2199023.255552, 300.0);
}

TEST(WindBox, AWindOverShallowWaterTakesItsDepthsSpeed) {
    StartWind wind = breeze();
    wind.reference_depth = 3.0F;
    const WaveTrainBox shallow = box_of(wind, {}, ids);
    const WaveTrainBox deep = box_of(breeze(), {}, ids);
    const double k = wave_number_at(wind_sea(9.0, wind.fetch).peak_omega, 3.0);
    EXPECT_NEAR(shallow.front_speed / 17179.869184, group_speed_at(k, 3.0), 1e-4);
    EXPECT_NEAR(to_metres(shallow.ramp_rear), 8.0 * pi / k, 0.01);
    EXPECT_LT(shallow.ramp_rear, deep.ramp_rear);
}

SceneBox hand_box() {
    SceneBox box;
    box.name = "by hand";
    box.towards_degrees = 90.0;
    box.origin = {to_lattice(-100.0), 0};
    box.length = to_lattice(400.0);
    box.width = to_lattice(200.0);
    box.ramp_rear = box.ramp_front = box.ramp_side = to_lattice(20.0);
    box.begin = {3 * second};
    box.build_up_us = 10 * second;
    box.life_us = 60 * second;
    box.decay_us = 20 * second;
    box.front_speed = 4.0;
    box.trains = {{20.0, 80.0, 0.2, 0.75, 0.9}, {50.0, 95.0, 0.5, 0.25, 1.0}};
    return box;
}

TEST(WindBox, HandWrittenBoxesKeepTheirFigures) {
    const auto result = box_of(hand_box(), ids);
    ASSERT_TRUE(result) << result.error().message;
    const WaveTrainBox& box = *result;
    EXPECT_EQ(box.origin, (LatticePoint{to_lattice(-100.0), to_lattice(-100.0)}));
    EXPECT_EQ(box.ux, 1 << 30);
    EXPECT_EQ(box.uz, 0);
    EXPECT_EQ(box.end, SeaTime{63 * second});
    EXPECT_NEAR(box.front_speed / 17179.869184, 4.0, 1e-4);
    ASSERT_EQ(box.trains.size(), 2U);
    // By falling wavelength: the 50 m train first.
    EXPECT_NEAR(2.0 * pi / wave_number_of({box.trains[0].kx, box.trains[0].kz}), 50.0, 1e-3);
    EXPECT_EQ(box.trains[0].amplitude, 0.5F);
    EXPECT_EQ(box.trains[0].phase, 1U << 30);
    EXPECT_EQ(box.trains[1].phase, 3U << 30);
    EXPECT_EQ(box.trains[1].choppiness, 0.9F);
    const StartWind wind = equivalent_wind(hand_box());
    const double hs = 4.0 * std::sqrt(0.5 * 0.25 + 0.5 * 0.04);
    EXPECT_NEAR(0.21 * std::pow(static_cast<double>(wind.speed), 2) / 9.80665, hs, 1e-5);
}

TEST(WindBox, HandWrittenBoxesOutsideTheWorldAreRefused) {
    SceneBox box = hand_box();
    box.origin.x = world_bound - 1;
    const auto result = box_of(box, ids);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::value_out_of_range);
}

}  // namespace
}  // namespace trochoid
