#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "protocol/model/irregular_height.hpp"
#include "protocol/model/round_wave.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

__extension__ typedef unsigned __int128 Wide;

constexpr double two_pi = 2.0 * std::numbers::pi;

IrregularHeight groups() {
    return {24'000,    4'001'003,          -5'003'001, 5'003'001,
            4'001'003, 141'700'000'000ULL, 77'777'777, 3'333'333'333U};
}

LatticePoint anywhere(uint64_t i) {
    const uint64_t a = splitmix64(i);
    const uint64_t b = splitmix64(a);
    return {static_cast<int64_t>(a >> 28) - (int64_t{1} << 35),
            static_cast<int64_t>(b >> 28) - (int64_t{1} << 35)};
}

TEST(IrregularHeight, IsTheProductOfTwoSinesAnywhereAndAtAnyTime) {
    const IrregularHeight g = groups();
    double worst = 0.0;
    for (uint64_t i = 0; i < 10'000; ++i) {
        const LatticePoint p = anywhere(i);
        const SeaTime t{static_cast<int64_t>(splitmix64(~i) % 630'000'000'000'000ULL) - 315'000'000'000'000};
        // Exact phases by wide integers.
        const auto turns = [&](int32_t kx, int32_t kz) {
            return static_cast<uint32_t>(static_cast<Wide>(kx) * static_cast<Wide>(p.x) +
                                         static_cast<Wide>(kz) * static_cast<Wide>(p.z));
        };
        const auto time = static_cast<uint32_t>((static_cast<Wide>(g.omega) * static_cast<Wide>(t.us)) >> 32);
        const uint32_t u = turns(g.ukx, g.ukz) + g.phase_u - time;
        const uint32_t v = turns(g.vkx, g.vkz) + g.phase_v;
        const double truth = 1.0 - g.share / 32768.0 * std::sin(two_pi * u / 4294967296.0) *
                                       std::sin(two_pi * v / 4294967296.0);
        const HeightModulation m = modulation_at(g, phases_at_origin(g, t), p);
        worst = std::max(worst, std::abs(static_cast<double>(m.factor) - truth));
    }
    EXPECT_LE(worst, 5e-7);
}

TEST(IrregularHeight, GradientIsThatOfTheFunctionAsEvaluated) {
    IrregularHeight g = groups();
    for (int32_t* k : {&g.ukx, &g.ukz, &g.vkx, &g.vkz}) *k /= 10;  // 6.7 m
    const IrregularPhases at = phases_at_origin(g, {123'456'789});
    double worst = 0.0;
    double steepest = 0.0;
    for (uint64_t i = 0; i < 5'000; ++i) {
        const LatticePoint p = anywhere(i);
        const HeightModulation m = modulation_at(g, at, p);
        constexpr int64_t step = 32;
        const double span = 2.0 * to_metres(step);
        const auto value = [&](int64_t dx, int64_t dz) {
            return static_cast<double>(modulation_at(g, at, {p.x + dx, p.z + dz}).factor);
        };
        const double dx = (value(step, 0) - value(-step, 0)) / span;
        const double dz = (value(0, step) - value(0, -step)) / span;
        worst = std::max(
            {worst, std::abs(dx - static_cast<double>(m.dx)), std::abs(dz - static_cast<double>(m.dz))});
        steepest = std::max(steepest, std::abs(dx));
    }
    EXPECT_GT(steepest, 0.4);
    EXPECT_LE(worst, 3e-4);
}

TEST(IrregularHeight, WithoutShareIsExactlyNeutral) {
    IrregularHeight g = groups();
    g.share = 0;
    EXPECT_EQ(modulation_at(g, {5, 7}, {123, -456}), HeightModulation{});
    EXPECT_TRUE(validate(g).has_value());
    EXPECT_TRUE(validate(groups()).has_value());
}

TEST(IrregularHeight, BadRecordsAreNamed) {
    const auto broken = [](auto change) {
        IrregularHeight g = groups();
        change(g);
        return !validate(g).has_value();
    };
    EXPECT_TRUE(broken([](IrregularHeight& g) { g.share = full_irregularity + 1; }));
    EXPECT_TRUE(broken([](IrregularHeight& g) { g.ukx = g.ukz = 0; }));
    EXPECT_TRUE(broken([](IrregularHeight& g) { g.vkx = g.vkz = 0; }));
    EXPECT_TRUE(broken([](IrregularHeight& g) { g.vkz = INT32_MIN; }));
}

TEST(WholeWaveNumber, IsTheFlooredRootForEveryVector) {
    for (uint64_t i = 0; i < 50'000; ++i) {
        const int shift = static_cast<int>(i % 31);
        const int32_t kx = static_cast<int32_t>(static_cast<uint32_t>(splitmix64(i))) >> shift;
        const int32_t kz = static_cast<int32_t>(static_cast<uint32_t>(splitmix64(~i))) >> shift;
        const uint64_t square =
            static_cast<uint64_t>(int64_t{kx} * kx) + static_cast<uint64_t>(int64_t{kz} * kz);
        const uint64_t root = whole_wave_number(kx, kz);
        EXPECT_LE(root * root, square);
        EXPECT_GT(static_cast<Wide>(root + 1) * (root + 1), square);
    }
    EXPECT_EQ(whole_wave_number(0, 1), 1U);
    EXPECT_EQ(whole_wave_number(-3, 4), 5U);
    EXPECT_EQ(whole_wave_number(INT32_MAX, INT32_MAX), 3'037'000'498U);
}

TEST(RoundWave, ShiftIsTheParabolaForEveryWidthWaveAndRoundness) {
    double worst = 0.0;
    double worst_slope = 0.0;
    for (uint64_t i = 0; i < 50'000; ++i) {
        const int64_t width = (int64_t{1} << (10 + i % 20)) + static_cast<int64_t>(splitmix64(i) % 1024);
        const auto v = static_cast<int64_t>(splitmix64(~i) % static_cast<uint64_t>(width));
        const auto k = static_cast<uint32_t>(splitmix64(i * 3) >> (32 + i % 16));
        const auto roundness = static_cast<uint16_t>(splitmix64(i * 5) % (full_roundness + 1));
        const RoundShift s = round_shift(roundness, k, width, v);
        const double off = static_cast<double>(v - width / 2);
        const double truth = roundness / 32768.0 * off * off / static_cast<double>(width) * k / 4294967296.0;
        // 2^40 / width is truncated, which is a slightly lower roundness: below 2^-10 of it for the widest boxes.
        const double slack = 1.0 / (static_cast<double>((int64_t{1} << 40) / width)) + 1e-6;
        // f has 31 bits, and n is a whole number.
        const double fine =
            std::abs(off) * k * 0x1p-63 + off * off / static_cast<double>(width) / 4294967296.0;
        worst = std::max(
            worst, std::abs(std::remainder(s.shift / 4294967296.0 - truth, 1.0)) - truth * slack - fine);
        const double slope =
            two_pi * roundness / 32768.0 * 2.0 * off / static_cast<double>(width) * k / 4194304.0;
        worst_slope =
            std::max(worst_slope, std::abs(static_cast<double>(s.slope) - slope) - std::abs(slope) * slack);
    }
    EXPECT_LE(worst, 1e-6);
    EXPECT_LE(worst_slope, 2e-5);
}

TEST(RoundWave, SlopeIsThatOfTheShiftAsEvaluatedAndTheSidesStandAt45Degrees) {
    const int64_t width = 1'300'007;
    const uint32_t k = 83'886;  // 50 m
    for (int64_t v = 2'000; v < width - 2'000; v += 9'973) {
        const RoundShift here = round_shift(full_roundness, k, width, v);
        const auto rise = static_cast<int32_t>(round_shift(full_roundness, k, width, v + 1024).shift -
                                               round_shift(full_roundness, k, width, v - 1024).shift);
        EXPECT_NEAR(two_pi * rise / 4294967296.0 / 2.0, static_cast<double>(here.slope), 2e-5) << v;
    }
    const double wave = two_pi * k / 4194304.0;
    EXPECT_NEAR(static_cast<double>(round_shift(full_roundness, k, width, width).slope) / wave, 1.0, 1e-4);
    EXPECT_NEAR(static_cast<double>(round_shift(full_roundness, k, width, 0).slope) / wave, -1.0, 1e-4);
    EXPECT_EQ(round_shift(full_roundness, k, width, -77).shift,
              round_shift(full_roundness, k, width, 0).shift);
    EXPECT_EQ(round_shift(full_roundness, k, width, width + 9).shift,
              round_shift(full_roundness, k, width, width).shift);
    EXPECT_EQ(round_shift(full_roundness, k, width, width / 2), RoundShift{});
    EXPECT_EQ(round_shift(0, k, width, 5).shift, 0U);
}

TEST(RoundWave, ShiftHasNoStepsEvenInTheWidestBox) {
    // Between two lattice units the shift changes by no more than the wave itself.
    const int64_t width = (int64_t{1} << 30) - 1;
    const uint32_t k = 1U << 22;  // 1 m
    uint32_t before = round_shift(full_roundness, k, width, 0).shift;
    int64_t worst = 0;
    for (int64_t v = 1; v < 200'000; ++v) {
        const uint32_t now = round_shift(full_roundness, k, width, v).shift;
        worst = std::max(worst, std::abs(int64_t{static_cast<int32_t>(now - before)}));
        before = now;
    }
    EXPECT_LE(worst, int64_t{k} * 2);
}

}  // namespace
}  // namespace trochoid
