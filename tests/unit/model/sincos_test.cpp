#include "protocol/model/sincos.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trochoid {
namespace {

double error_at(uint32_t phase) {
    const SinCos v = sincos_turns(phase);
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(phase) / 4294967296.0;
    return std::max(std::abs(static_cast<double>(v.sin) - std::sin(angle)),
                    std::abs(static_cast<double>(v.cos) - std::cos(angle)));
}

TEST(SinCos, StaysWithinItsStatedBoundOverTheTurn) {
    double worst = 0.0;
    // A step coprime to 2^32 visits every octant and every low-bit pattern.
    uint32_t phase = 0;
    for (int i = 0; i < 4'000'000; ++i, phase += 1073741789U) worst = std::max(worst, error_at(phase));
    EXPECT_LE(worst, 1.6e-7);
    EXPECT_GT(worst, 1e-8) << "a test that measures nothing";
}

TEST(SinCos, HoldsAtEveryOctantBorder) {
    for (uint64_t octant = 0; octant < 8; ++octant)
        for (int64_t d = -2; d <= 2; ++d) {
            const auto phase = static_cast<uint32_t>((octant << 29) + static_cast<uint64_t>(d));
            EXPECT_LE(error_at(phase), 1.6e-7) << phase;
        }
}

TEST(SinCos, QuarterTurnsHaveTheirSigns) {
    EXPECT_EQ(sincos_turns(0).cos, 1.0F);
    EXPECT_EQ(sincos_turns(0x40000000U).sin, 1.0F);
    EXPECT_EQ(sincos_turns(0x80000000U).cos, -1.0F);
    EXPECT_EQ(sincos_turns(0xc0000000U).sin, -1.0F);
}

}  // namespace
}  // namespace trochoid
