#include "protocol/model/wave_train_box.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "protocol/model/self_check.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

WaveTrainBox wind_box() { return reference_sea().boxes()[1]->record; }
WaveTrainBox ship_box() { return reference_sea().boxes()[3]->record; }

TEST(Envelope, RampsAreLinearAndReachBothEnds) {
    for (const int32_t length : {1 << 10, 12'345, 1 << 20, 1 << 30}) {
        EXPECT_EQ(ramp_gain(0, length), 0U);
        EXPECT_EQ(ramp_gain(-5, length), 0U);
        EXPECT_EQ(ramp_gain(length, length), full_gain);
        for (int i = 1; i < 16; ++i) {
            const int64_t d = int64_t{length} * i / 16;
            EXPECT_NEAR(static_cast<double>(ramp_gain(d, length)) / full_gain,
                        static_cast<double>(d) / length, 1e-6);
        }
        EXPECT_LE(ramp_gain(length - 1, length), full_gain);
    }
}

TEST(Envelope, IsZeroOnAndOutsideAllFourSidesAndFullInside) {
    const WaveTrainBox box = wind_box();
    const BoxInstant grown = instant_of(box, box.begin + 100'000'000'000);
    ASSERT_EQ(grown.time_gain, full_gain);
    ASSERT_EQ(grown.front, box.length);
    const auto at = [&](double u, double v) {
        const double ux = box.ux / 1073741824.0;
        const double uz = box.uz / 1073741824.0;
        return LatticePoint{box.origin.x + static_cast<int64_t>(std::llround(u * ux - v * uz)),
                            box.origin.z + static_cast<int64_t>(std::llround(u * uz + v * ux))};
    };
    const auto length = static_cast<double>(box.length);
    const auto width = static_cast<double>(box.width);
    EXPECT_EQ(envelope_at(box, grown, at(length / 2, width / 2)).gain, full_gain);
    for (const double f : {0.1, 0.5, 0.9}) {
        EXPECT_LE(envelope_at(box, grown, at(1, f * width)).gain, 1000U);
        EXPECT_EQ(envelope_at(box, grown, at(-10, f * width)).gain, 0U);
        EXPECT_EQ(envelope_at(box, grown, at(length + 10, f * width)).gain, 0U);
        EXPECT_EQ(envelope_at(box, grown, at(f * length, -10)).gain, 0U);
        EXPECT_EQ(envelope_at(box, grown, at(f * length, width + 10)).gain, 0U);
    }
}

TEST(Envelope, FarAwayIsNoGhostBox) {
    // 4194 km on, the low 32 bits of the position are the same again.
    const WaveTrainBox box = wind_box();
    const BoxInstant grown = instant_of(box, box.begin + 100'000'000'000);
    const LatticePoint centre{box.origin.x + ((box.length / 2 * box.ux - box.width / 2 * box.uz) >> 30),
                              box.origin.z + ((box.length / 2 * box.uz + box.width / 2 * box.ux) >> 30)};
    EXPECT_EQ(envelope_at(box, grown, centre).gain, full_gain);
    EXPECT_EQ(envelope_at(box, grown, {centre.x + (int64_t{1} << 32), centre.z}).gain, 0U);
    EXPECT_EQ(envelope_at(box, grown, {world_bound, -world_bound}).gain, 0U);
}

TEST(Envelope, GrowsStaysAndDecaysInTime) {
    const WaveTrainBox box = wind_box();
    EXPECT_EQ(instant_of(box, box.begin - 1).time_gain, 0U);
    EXPECT_NEAR(instant_of(box, box.begin + box.build_up_us / 2).time_gain, full_gain / 2.0, 1.0);
    EXPECT_EQ(instant_of(box, box.end).time_gain, full_gain);
    EXPECT_NEAR(instant_of(box, box.end + box.decay_us / 4).time_gain, full_gain * 0.75, 2.0);
    EXPECT_EQ(instant_of(box, box.end + box.decay_us).time_gain, 0U);
    EXPECT_EQ(instant_of(box, end_of_time).time_gain, 0U);
}

TEST(Envelope, FrontAdvancesAtItsSpeed) {
    const WaveTrainBox box = wind_box();
    const double units_per_us = box.front_speed / 16777216.0;
    EXPECT_NEAR(static_cast<double>(instant_of(box, box.begin + 10'000'000).front), units_per_us * 1e7, 1.0);
    EXPECT_EQ(instant_of(box, box.begin + int64_t{1'000'000'000'000}).front, box.length);
}

TEST(Envelope, ASuccessorIsAsFarGrownAsItsPredecessorWouldBe) {
    WaveTrainBox old = wind_box();
    WaveTrainBox next = old;
    next.id = {9};
    next.begin = old.begin + 200'000'000;
    next.raised_us = 200'000'000;
    next.fade_us = 10'000'000;
    EXPECT_EQ(instant_of(next, next.begin - 1).time_gain, 0U);
    EXPECT_EQ(instant_of(next, next.begin).time_gain, 0U);
    for (const int64_t us : {10'000'000LL, 17'000'000LL, 300'000'000LL, 500'000'000LL, 100'000'000'000LL}) {
        EXPECT_EQ(instant_of(next, next.begin + us), instant_of(old, next.begin + us)) << us;
        EXPECT_EQ(instant_of(next, next.begin + us).front, instant_of(old, next.begin + us).front);
    }
    old.end = next.begin;
    old.decay_us = next.fade_us;
    WaveTrainBox unchanged = wind_box();
    for (int64_t us = 0; us <= 10'000'000; us += 9'973) {
        const int64_t sum =
            int64_t{instant_of(old, next.begin + us).time_gain} + instant_of(next, next.begin + us).time_gain;
        EXPECT_LE(std::abs(sum - int64_t{instant_of(unchanged, next.begin + us).time_gain}), 2) << us;
    }
}

TEST(Envelope, AWakesEndsFallBehindAtHalfTheShipsSpeed) {
    const WaveTrainBox ship = ship_box();
    const auto metres_behind = [&](int64_t seconds) {
        return to_metres(instant_of(ship, ship.begin + seconds * 1'000'000).wake_rear);
    };
    EXPECT_NEAR(metres_behind(1), 3.0, 0.01);
    EXPECT_NEAR(metres_behind(800), 2400.0, 0.2);
    EXPECT_EQ(instant_of(ship, ship.begin).wake_rear, 0);
    EXPECT_EQ(instant_of(ship, ship.end).wake_front, 0);
    EXPECT_NEAR(to_metres(instant_of(ship, ship.end + 100'000'000).wake_front), 300.0, 0.1);
    WaveTrainBox eternal = ship;
    eternal.begin = {-sea_time_bound};
    eternal.end = end_of_time;
    EXPECT_EQ(instant_of(eternal, {0}).wake_rear, INT32_MAX);
    EXPECT_EQ(instant_of(wind_box(), {1'000'000'000}).wake_rear, 0);
}

TEST(Envelope, ExtremeTimesDoNotOverflow) {
    WaveTrainBox box = wind_box();
    box.begin = {-sea_time_bound};
    box.raised_us = sea_time_bound;
    box.end = end_of_time;
    box.decay_us = int64_t{1} << 39;
    ASSERT_TRUE(validate(box).has_value());
    for (const int64_t us : {-sea_time_bound, int64_t{0}, sea_time_bound})
        EXPECT_EQ(instant_of(box, {us}).time_gain, full_gain) << us;
    EXPECT_EQ(instant_of(box, {sea_time_bound}).front, box.length);
}

TEST(Bounds, OfHeightAndDisplacementCountWakeNoiseAndIrregularHeights) {
    for (size_t i = 0; i < 6; ++i) {
        const Sea sea({reference_sea().boxes()[i]});
        const WaveTrainBox& box = sea.boxes()[0]->record;
        double highest = 0.0;
        double widest = 0.0;
        for (uint64_t j = 0; j < 4000; ++j) {
            const LatticePoint p{static_cast<int64_t>(splitmix64(j) % 4'000'000) - 2'000'000,
                                 static_cast<int64_t>(splitmix64(~j) % 4'000'000) - 2'000'000};
            const SeaTime t{static_cast<int64_t>(splitmix64(j / 64) % 900'000'000)};
            const SurfaceSample s = SeaInstant(sea, t, displayed_layers).evaluate(p);
            highest = std::max(highest, std::abs(static_cast<double>(s.ay)));
            widest = std::max(widest, std::hypot(static_cast<double>(s.ax), static_cast<double>(s.az)));
        }
        EXPECT_LE(highest, height_bound(box)) << i;
        EXPECT_LE(widest, displacement_bound(box)) << i;
        EXPECT_GT(highest, 0.05 * height_bound(box)) << i;
    }
    WaveTrainBox storm = reference_sea().boxes()[2]->record;
    const double with = height_bound(storm);
    storm.irregular = {};
    EXPECT_NEAR(with - height_bound(storm), 0.8125 * 58'000 / 32'768.0 * 20'000 / 32'768.0, 1e-3);
    storm.noise = {};
    EXPECT_NEAR(height_bound(storm), 0.8125 * 58'000 / 32'768.0, 1e-3);
    EXPECT_NEAR(height_bound(ship_box()), wake_bound(ship_box().wake), 1e-3);
}

TEST(Bounds, ContainEveryPointWithAGain) {
    const WaveTrainBox box = wind_box();
    const LatticeRect bounds = bounds_of(box);
    const BoxInstant grown = instant_of(box, box.begin + 100'000'000'000);
    int inside = 0;
    for (uint64_t i = 0; i < 20'000; ++i) {
        const LatticePoint p{static_cast<int64_t>(splitmix64(i) % 8'000'000) - 4'000'000,
                             static_cast<int64_t>(splitmix64(i + 77'777) % 8'000'000) - 4'000'000};
        if (envelope_at(box, grown, p).gain == 0) continue;
        ++inside;
        EXPECT_TRUE(contains(bounds, p));
    }
    EXPECT_GT(inside, 100);
}

TEST(Validation, NamesEachFieldOutOfRange) {
    const auto broken = [](auto change) {
        WaveTrainBox box = wind_box();
        change(box);
        const auto result = validate(box);
        return result ? ErrorCode::none : result.error().code;
    };
    EXPECT_EQ(broken([](WaveTrainBox&) {}), ErrorCode::none);
    const auto range = ErrorCode::value_out_of_range;
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.id = {}; }), range);
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.origin.x = world_bound + 1; }), range);
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.ux /= 2; }), range);
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.length = longest_side + 1; }), range);
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.width = -1; }), range);
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.ramp_side = 1023; }), range);
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.end = b.begin - 1; }), range);
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.decay_us = int64_t{1} << 40; }), range);
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.trains.clear(); }), range);
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.trains[0].kx = b.trains[0].kz = 0; }), range);
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.trains[0].amplitude = 33.0F; }), range);
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.trains[0].amplitude = -0.0F; }), range);
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.trains[0].choppiness = 4.5F; }), range);
    EXPECT_EQ(broken([](WaveTrainBox& b) { b.trains[0].amplitude = std::nanf(""); }), ErrorCode::not_finite);
}

TEST(Validation, FeaturesMustFitTheirBox) {
    const auto broken = [](size_t index, auto change) {
        WaveTrainBox box = reference_sea().boxes()[index]->record;
        change(box);
        return !validate(box).has_value();
    };
    for (size_t i = 0; i < 6; ++i) EXPECT_FALSE(broken(i, [](WaveTrainBox&) {})) << i;
    constexpr size_t storm = 2;
    constexpr size_t ship = 3;
    constexpr size_t noise = 5;
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.raised_us = -1; }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.raised_us = sea_time_bound + 1; }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.fade_us = (int64_t{1} << 39) + 1; }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.roundness = full_roundness + 1; }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.width = 0; }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.trains[2].kx = 1 << 25; }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.width = 1023; }));
    EXPECT_FALSE(broken(storm, [](WaveTrainBox& b) { b.width = b.roundness = 0; }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.overlays[0].base = b.overlays[0].field; }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.overlays[0].base = {}; }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.overlays.push_back(b.overlays[0]); }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.origin.x += 1; }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.course[0].duration_us = -1; }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.irregular.share = full_irregularity + 1; }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.noise.octaves = 0; }));
    EXPECT_FALSE(broken(storm, [](WaveTrainBox& b) { b.trains.clear(); }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.trains.clear(), b.noise = {}; }));
    EXPECT_TRUE(broken(storm, [](WaveTrainBox& b) { b.trains.resize(257, b.trains[0]); }));
    EXPECT_FALSE(broken(storm, [](WaveTrainBox& b) { b.trains.resize(256, b.trains[0]); }));
    EXPECT_TRUE(broken(ship, [](WaveTrainBox& b) { b.course.clear(); }));
    EXPECT_TRUE(broken(ship, [](WaveTrainBox& b) {
        b.course.push_back(b.course[0]);
        b.course[1].from = b.course[1].from + 5;
    }));
    EXPECT_TRUE(broken(ship, [](WaveTrainBox& b) { b.length = 0; }));
    EXPECT_TRUE(broken(ship, [](WaveTrainBox& b) { b.width = 0; }));
    EXPECT_TRUE(broken(ship, [](WaveTrainBox& b) { b.wake.inverse_length = 5; }));
    EXPECT_TRUE(broken(ship, [](WaveTrainBox& b) { b.wake = {}; }));
    EXPECT_TRUE(broken(noise, [](WaveTrainBox& b) { b.noise.amplitude = 0.0F; }));
}

}  // namespace
}  // namespace trochoid
