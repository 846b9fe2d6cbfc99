#include "server/net/view_motion.hpp"

#include <gtest/gtest.h>

namespace trochoid {
namespace {

constexpr int64_t second = 1'000'000;

/// Turned about the vertical by this angle, radians.
ViewState turned(double angle) {
    ViewState v;
    v.qy = static_cast<float>(std::sin(angle / 2.0));
    v.qw = static_cast<float>(std::cos(angle / 2.0));
    return v;
}

TEST(ViewMotion, TellsTheRateOfTurnOfTheLastViews) {
    ViewMotion motion;
    EXPECT_EQ(motion.turn(5 * second), 0.0);
    motion.take(turned(0.0), turned(0.3), 5 * second);
    EXPECT_EQ(motion.turn(5 * second), 0.0) << "one view alone has no rate";
    motion.take(turned(0.3), turned(0.35), 5 * second + 100'000);
    EXPECT_NEAR(motion.turn(5 * second + 150'000), 0.5, 1e-3);
    motion.take(turned(0.35), turned(-0.15), 5 * second + 1'100'000);
    EXPECT_NEAR(motion.turn(5 * second + 1'200'000), 0.5, 1e-3) << "either way round";
    EXPECT_EQ(motion.turn(8 * second), 0.0) << "views come on change: none for a second is a camera at rest";
}

TEST(ViewMotion, OppositeQuaternionsAreOneDirectionAndBurstsNoEndlessTurn) {
    ViewMotion motion;
    motion.take(turned(0.0), turned(0.0), second);
    ViewState other = turned(0.2);
    other.qy = -other.qy, other.qw = -other.qw;
    motion.take(turned(0.2), other, second + 100'000);
    EXPECT_NEAR(motion.turn(second + 100'000), 0.0, 1e-2);
    motion.take(turned(0.0), turned(0.4), second + 100'000);
    EXPECT_NEAR(motion.turn(second + 100'000), 20.0, 0.1) << "two views in one read";
}

}  // namespace
}  // namespace trochoid
