#include "protocol/wire/rate_limit.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace trochoid {
namespace {

int taken(RateLimit& limit, int64_t now_us, int tries) {
    int n = 0;
    for (int i = 0; i < tries; ++i) n += limit.take(now_us) ? 1 : 0;
    return n;
}

TEST(RateLimit, GivesTheBurstAtOnceAndThenTheRate) {
    RateLimit limit(10, 30);
    EXPECT_EQ(taken(limit, 5'000'000, 100), 30);
    EXPECT_EQ(taken(limit, 5'099'999, 100), 0);
    EXPECT_EQ(taken(limit, 5'100'000, 100), 1);
    EXPECT_EQ(taken(limit, 6'100'000, 100), 10);
    EXPECT_EQ(taken(limit, 3'600'000'000, 100), 30) << "never more than the burst";
}

TEST(RateLimit, ManySmallStepsAddUpExactly) {
    RateLimit limit(30, 1);
    ASSERT_TRUE(limit.take(0));
    int n = 0;
    for (int64_t t = 1; t <= 10'000'000; t += 7) n += limit.take(t) ? 1 : 0;
    EXPECT_EQ(n, 299);  // a burst of 1 loses what comes between its being full and the next try
}

TEST(RateLimit, TimeThatStepsBackGivesNothing) {
    RateLimit limit(1000, 2);
    EXPECT_EQ(taken(limit, 1'000'000, 5), 2);
    EXPECT_EQ(taken(limit, 0, 5), 0);
    EXPECT_EQ(taken(limit, 1'000'000, 5), 0);
    EXPECT_EQ(taken(limit, 1'001'000, 5), 1);
}

TEST(RateLimit, ExtremeTimesDoNotOverflow) {
    RateLimit limit(UINT32_MAX, UINT32_MAX);
    EXPECT_TRUE(limit.take(INT64_MIN));
    EXPECT_TRUE(limit.take(INT64_MAX));
    RateLimit slow(1);
    EXPECT_TRUE(slow.take(INT64_MIN));
    EXPECT_FALSE(slow.take(INT64_MIN));
    EXPECT_EQ(taken(slow, INT64_MAX, 3), 1);
}

}  // namespace
}  // namespace trochoid
