#include "protocol/model/box_course.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "protocol/model/self_check.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

__extension__ typedef __int128 Wide;

std::vector<CourseLeg> two_legs() {
    return {{{1'000'000}, 600'000'000, {5'000, -7'000}, 85'900, -17'180},
            {{900'000'000}, longest_leg_us, {3'076'000, -622'000}, -1, fastest_leg - 1}};
}

/// The slow twin: a search from the last leg, 128-bit products, floor by division.
LatticePoint twin(const std::vector<CourseLeg>& legs, SeaTime t) {
    const CourseLeg* on = legs.data();
    for (const CourseLeg& leg : legs)
        if (leg.from <= t) on = &leg;
    const Wide elapsed = Wide{t.us} - on->from.us;
    const Wide moved = elapsed < 0 ? 0 : (elapsed > on->duration_us ? Wide{on->duration_us} : elapsed);
    const auto floored = [](Wide v) {
        const Wide q = v / (1 << 24);
        return static_cast<int64_t>(v % (1 << 24) < 0 ? q - 1 : q);
    };
    return {on->origin.x + floored(on->vx * moved), on->origin.z + floored(on->vz * moved)};
}

TEST(BoxCourse, AgreesWithTheWideTwinAtAnyTime) {
    for (uint64_t i = 0; i < 20'000; ++i) {
        const SeaTime t{static_cast<int64_t>(splitmix64(i) % 4'000'000'000'000ULL) - 1'000'000'000'000};
        EXPECT_EQ(corner_at(two_legs(), t), twin(two_legs(), t)) << t.us;
    }
    for (const int64_t us : {-sea_time_bound, int64_t{999'999}, int64_t{1'000'000}, int64_t{601'000'000},
                             int64_t{899'999'999}, int64_t{900'000'000}, sea_time_bound})
        EXPECT_EQ(corner_at(two_legs(), {us}), twin(two_legs(), {us})) << us;
}

TEST(BoxCourse, LiesStillBeforeItsFirstLegAndAfterEachLeg) {
    const auto legs = two_legs();
    EXPECT_EQ(corner_at(legs, {-5}), legs[0].origin);
    EXPECT_EQ(corner_at(legs, {700'000'000}), corner_at(legs, {601'000'000}));
    EXPECT_EQ(corner_at(legs, {900'000'000}), legs[1].origin);
    // 5 m/s east for ten minutes is 3 km.
    EXPECT_NEAR(to_metres(corner_at(legs, {601'000'000}).x - legs[0].origin.x), 3000.0, 0.1);
}

TEST(BoxCourse, BadCoursesAreNamed) {
    const auto broken = [](auto change) {
        std::vector<CourseLeg> legs{{{0}, 1'000'000, {0, 0}, 5, 5}, {{10}, 1'000'000, {0, 0}, 5, 5}};
        change(legs);
        return !validate(std::span<const CourseLeg>(legs)).has_value();
    };
    EXPECT_FALSE(broken([](auto&) {}));
    EXPECT_FALSE(broken([](auto& l) { l.clear(); }));
    EXPECT_TRUE(broken([](auto& l) { l[1].from = l[0].from; }));
    EXPECT_TRUE(broken([](auto& l) { l[1].duration_us = -1; }));
    EXPECT_TRUE(broken([](auto& l) { l[1].duration_us = longest_leg_us + 1; }));
    EXPECT_TRUE(broken([](auto& l) { l[0].vx = fastest_leg; }));
    EXPECT_TRUE(broken([](auto& l) { l[0].vz = INT32_MIN; }));
    EXPECT_TRUE(broken([](auto& l) { l[0].origin.x = world_bound + 1; }));
    EXPECT_TRUE(broken([](auto& l) { l[0].from.us = sea_time_bound + 1; }));
    EXPECT_TRUE(broken([](auto& l) {
        l[0] = {{0}, longest_leg_us, {world_bound - 1'000'000, 0}, fastest_leg - 1, 0};
    }));
    EXPECT_TRUE(broken([](auto& l) {
        for (int i = 0; i < 64; ++i) l.push_back({{100 + i}, 0, {}, 0, 0});
    }));
}

TEST(MovingBox, IsTheStandingBoxWhereItsCornerIs) {
    // Bit for bit: only the envelope moves, so at each instant a box without course at that corner is the same sea.
    const Sea sea = reference_sea();
    WaveTrainBox record = sea.boxes()[2]->record;
    int wet = 0;
    for (uint64_t i = 0; i < 400; ++i) {
        const SeaTime t{static_cast<int64_t>(splitmix64(i) % 1'200'000'000) - 100'000'000};
        WaveTrainBox still = record;
        still.origin = corner_at(record.course, t);
        still.course.clear();
        const SeaInstant moving(Sea({prepare(record, {})}), t);
        const SeaInstant standing(Sea({prepare(still, {})}), t);
        for (uint64_t j = 0; j < 10; ++j) {
            const uint64_t h = splitmix64(i * 100 + j);
            const LatticePoint p{static_cast<int64_t>(h % 6'000'000) - 3'000'000,
                                 static_cast<int64_t>((h >> 32) % 6'000'000) - 3'000'000};
            EXPECT_EQ(moving.evaluate(p), standing.evaluate(p));
            if (moving.evaluate(p) != SurfaceSample{}) ++wet;
        }
    }
    EXPECT_GT(wet, 200);
}

TEST(MovingBox, BoundsHoldAtEveryTimeAndSpan) {
    const WaveTrainBox record = reference_sea().boxes()[2]->record;
    const LatticeRect always = bounds_of(record);
    int inside = 0;
    for (uint64_t i = 0; i < 40'000; ++i) {
        const uint64_t h = splitmix64(i);
        const LatticePoint p{static_cast<int64_t>(h % 8'000'000) - 4'000'000,
                             static_cast<int64_t>((h >> 30) % 8'000'000) - 4'000'000};
        const SeaTime t{static_cast<int64_t>(splitmix64(h) % 1'100'000'000) - 50'000'000};
        if (envelope_at(record, instant_of(record, t), p).gain == 0) continue;
        ++inside;
        EXPECT_TRUE(contains(always, p));
        EXPECT_TRUE(contains(bounds_over(record, t, t), p)) << t.us;
        EXPECT_TRUE(contains(bounds_over(record, t - 123'456'789, t + 300'000'000), p)) << t.us;
        EXPECT_TRUE(contains(bounds_over(record, t - 1'000'000'000, t), p)) << t.us;
    }
    EXPECT_GT(inside, 1000);
    // A span takes less than the whole course.
    const LatticeRect once = bounds_over(record, {0}, {0});
    EXPECT_LT(once.max.x - once.min.x, always.max.x - always.min.x);
}

}  // namespace
}  // namespace trochoid
