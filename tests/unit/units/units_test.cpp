#include <gtest/gtest.h>

#include "protocol/units/error_code.hpp"
#include "protocol/units/hash.hpp"
#include "protocol/units/lattice.hpp"
#include "protocol/units/result.hpp"
#include "protocol/units/sea_time.hpp"
#include "protocol/units/version.hpp"

namespace trochoid {
namespace {

TEST(Lattice, RoundsToNearestAndBack) {
    EXPECT_EQ(to_lattice(1.0), 1024);
    EXPECT_EQ(to_lattice(-0.0005), -1);
    EXPECT_EQ(to_lattice(0.00048), 0);
    for (const double metres : {0.0, 1.5, -33'554'432.0, 1234.0625})
        EXPECT_DOUBLE_EQ(to_metres(to_lattice(metres)), metres);
}

TEST(Lattice, WorldIsClosedAtItsBound) {
    EXPECT_TRUE(inside_world({world_bound, -world_bound}));
    EXPECT_FALSE(inside_world({world_bound + 1, 0}));
    EXPECT_FALSE(inside_world({0, -world_bound - 1}));
}

TEST(Lattice, RectanglesAreClosed) {
    const LatticeRect a{{0, 0}, {10, 10}};
    EXPECT_TRUE(contains(a, {10, 0}));
    EXPECT_FALSE(contains(a, {11, 0}));
    EXPECT_TRUE(overlap(a, {{10, 10}, {20, 20}}));
    EXPECT_FALSE(overlap(a, {{11, 0}, {20, 20}}));
}

TEST(Hash, IsFnv1aOverLittleEndianBytes) {
    // Known FNV-1a 64 value of "a".
    const uint8_t a[] = {'a'};
    EXPECT_EQ(Hash64().bytes(a).value(), 0xaf63dc4c8601ec8cULL);
    const uint8_t bytes[] = {0x04, 0x03, 0x02, 0x01};
    EXPECT_EQ(Hash64().u32(0x01020304).value(), Hash64().bytes(bytes).value());
    EXPECT_NE(Hash64().f32(0.0F).value(), Hash64().f32(-0.0F).value());
}

TEST(Hash, SplitmixMatchesItsReference) {
    // First outputs of Vigna's splitmix64 from state 0.
    EXPECT_EQ(splitmix64(0), 0xe220a8397b1dcdafULL);
    EXPECT_EQ(splitmix64(0x9e3779b97f4a7c15ULL), 0x6e789e6aa1b965f4ULL);
}

TEST(Errors, ClassesFollowTheHundreds) {
    EXPECT_EQ(error_class(ErrorCode::not_finite), "protocol");
    EXPECT_EQ(error_class(ErrorCode::token_required), "auth");
    EXPECT_EQ(error_class(ErrorCode::wrong_world), "world");
    EXPECT_EQ(error_class(static_cast<ErrorCode>(999)), "unknown");
}

TEST(Errors, AskingForTheWrongSideAsserts) {
    const Result<int> good = 3;
    const Result<int> bad = Error{ErrorCode::rate_limited, "slower"};
    EXPECT_EQ(*good, 3);
    EXPECT_EQ(bad.error().code, ErrorCode::rate_limited);
    EXPECT_DEATH((void)bad.value(), "slower");
    EXPECT_DEATH((void)good.error(), "assertion failed");
}

TEST(SeaTimes, RoundHalfAwayFromZero) {
    EXPECT_EQ(seconds_to_us(1.5), 1'500'000);
    EXPECT_EQ(seconds_to_us(-0.0000005), -1);
}

TEST(Version, NamesProgramProtocolAndModel) {
    const std::string text = version_text("trochoid-server");
    EXPECT_EQ(text.rfind("trochoid-server ", 0), 0U);
    EXPECT_NE(text.find("model 2"), std::string::npos);
}

}  // namespace
}  // namespace trochoid
