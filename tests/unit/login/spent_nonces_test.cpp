#include "protocol/login/spent_nonces.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include <random>
#include <vector>

namespace trochoid {
namespace {

using Outcome = SpentNonces::Outcome;

Nonce nonce_of(uint64_t number) {
    Nonce nonce{};
    for (size_t i = 0; i < 8; ++i) nonce[i] = static_cast<uint8_t>(number >> (8 * i));
    return nonce;
}

TEST(SpentNonce, IsGoodOnce) {
    SpentNonces spent;
    EXPECT_EQ(spent.spend(nonce_of(1), {100}, {10}), Outcome::first_time);
    EXPECT_EQ(spent.spend(nonce_of(1), {100}, {10}), Outcome::used_before);
    EXPECT_EQ(spent.spend(nonce_of(1), {500}, {100}), Outcome::used_before) << "to the last second";
    EXPECT_EQ(spent.spend(nonce_of(2), {100}, {101}), Outcome::too_old);
    EXPECT_EQ(spent.size(), 0U);
}

TEST(SpentNonce, AClockThatIsSetBackMakesNothingGoodAgain) {
    SpentNonces spent;
    EXPECT_EQ(spent.spend(nonce_of(1), {100}, {10}), Outcome::first_time);
    EXPECT_EQ(spent.spend(nonce_of(2), {900}, {800}), Outcome::first_time);
    EXPECT_EQ(spent.size(), 1U) << "the first is forgotten";
    EXPECT_EQ(spent.spend(nonce_of(1), {100}, {20}), Outcome::too_old);
}

TEST(SpentNonce, WhenFullNothingIsForgotten) {
    SpentNonces spent(3);
    for (uint64_t i = 0; i < 3; ++i)
        EXPECT_EQ(spent.spend(nonce_of(i), {100 + i}, {10}), Outcome::first_time);
    EXPECT_EQ(spent.spend(nonce_of(9), {200}, {10}), Outcome::full);
    EXPECT_EQ(spent.spend(nonce_of(0), {100}, {10}), Outcome::used_before);
    EXPECT_EQ(spent.spend(nonce_of(9), {200}, {101}), Outcome::first_time) << "the first has made room";
}

// Against a list that forgets nothing.
TEST(SpentNonce, AgreesWithAnEndlessMemory) {
    std::mt19937 dice(5);
    SpentNonces spent(1'000'000);
    std::vector<Nonce> used;
    uint64_t newest = 0;
    for (int step = 0; step < 20'000; ++step) {
        const uint64_t now = static_cast<uint64_t>(step) / 50 + dice() % 20;
        newest = std::max(newest, now);
        const uint64_t number = dice() % 500;
        const UnixSeconds until{number * 400 / 500};  // a nonce always has the same
        const bool before = std::find(used.begin(), used.end(), nonce_of(number)) != used.end();
        const Outcome expected = until.value < newest ? Outcome::too_old
                                 : before             ? Outcome::used_before
                                                      : Outcome::first_time;
        ASSERT_EQ(spent.spend(nonce_of(number), until, {now}), expected) << step;
        if (expected == Outcome::first_time) used.push_back(nonce_of(number));
    }
    EXPECT_GT(used.size(), 300U);
}

}  // namespace
}  // namespace trochoid
