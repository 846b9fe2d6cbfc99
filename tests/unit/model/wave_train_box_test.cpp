#include "protocol/model/wave_train_box.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "protocol/model/self_check.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

WaveTrainBox wind_box() { return reference_sea().boxes()[1]->record; }

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

}  // namespace
}  // namespace trochoid
