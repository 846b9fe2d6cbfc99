#include "client/store/clock_estimator.hpp"

#include <gtest/gtest.h>

#include <random>

namespace trochoid {
namespace {

/// A server whose monotonic clock is `ahead` of the client's and drifts; the two ways of a message take different times.
struct Simulation {
    int64_t ahead_us = 123'456'789;
    double drift = 0.0;  // server microseconds gained per client microsecond
    SeaClock clock{1, SeaTime{5'000'000}, 100'000'000, 1U << 16};
    ClockEstimator estimator;

    int64_t server_at(int64_t client_us) const {
        return client_us + ahead_us + static_cast<int64_t>(drift * static_cast<double>(client_us));
    }
    SeaTime truth(int64_t client_us) const { return sea_time_at(clock, server_at(client_us)); }
    int64_t hello(int64_t sent_us, int64_t there_us, int64_t back_us) {
        ServerHello hello;
        hello.clock = clock;
        hello.client_stamp_us = sent_us;
        hello.server_now_us = server_at(sent_us + there_us);
        estimator.begin(hello, sent_us + there_us + back_us);
        return sent_us + there_us + back_us;
    }
    int64_t exchange(int64_t sent_us, int64_t there_us, int64_t held_us, int64_t back_us) {
        ClockReply reply;
        reply.clock = clock;
        reply.client_sent_us = sent_us;
        reply.server_received_us = server_at(sent_us + there_us);
        reply.server_sent_us = server_at(sent_us + there_us + held_us);
        const int64_t received_us = sent_us + there_us + held_us + back_us;
        estimator.add(reply, received_us);
        return received_us;
    }
    int64_t error_us(int64_t client_us) { return std::abs(estimator.sea_time(client_us) - truth(client_us)); }
};

TEST(ClockEstimator, equal_ways_give_the_exact_offset) {
    Simulation s;
    const int64_t now = s.hello(1'000'000, 4000, 4000);
    EXPECT_TRUE(s.estimator.known());
    EXPECT_EQ(s.error_us(now), 0);
    EXPECT_EQ(s.estimator.round_trip_us(), 8000);
    EXPECT_EQ(s.estimator.error_bound_us(now), 4001);
}

TEST(ClockEstimator, unequal_ways_stay_within_the_bound) {
    for (const auto& [there, back] : {std::pair<int64_t, int64_t>{20'000, 0}, {0, 20'000}, {100, 9000}}) {
        Simulation s;
        const int64_t now = s.hello(1'000'000, there, back);
        EXPECT_LE(s.error_us(now), s.estimator.error_bound_us(now));
        EXPECT_GT(s.error_us(now), 0);
    }
}

TEST(ClockEstimator, follows_the_exchange_with_the_least_delay) {
    Simulation s;
    s.hello(1'000'000, 30'000, 2000);
    int64_t now = 0;
    for (int i = 0; i < 6; ++i)
        now = s.exchange(2'000'000 + i * 50'000, i == 3 ? 100 : 25'000, 700, i == 3 ? 100 : 1000);
    EXPECT_EQ(s.estimator.round_trip_us(), 200);
    EXPECT_LE(s.estimator.error_bound_us(now), 150);
    EXPECT_LE(s.error_us(now), s.estimator.error_bound_us(now));
}

TEST(ClockEstimator, time_that_the_server_holds_a_request_counts_for_nothing) {
    Simulation s;
    s.hello(1'000'000, 30'000, 2000);
    const int64_t now = s.exchange(2'000'000, 300, 90'000, 300);
    EXPECT_EQ(s.estimator.round_trip_us(), 600);
    EXPECT_EQ(s.error_us(now), 0);
}

TEST(ClockEstimator, bound_holds_and_time_never_steps_back_under_drift_and_jitter) {
    std::mt19937 dice(7);
    std::uniform_int_distribution<int64_t> way(50, 40'000);
    for (const double drift : {-9e-5, 0.0, 9e-5}) {
        Simulation s;
        s.drift = drift;
        int64_t now = s.hello(1'000'000, way(dice), way(dice));
        SeaTime last = s.estimator.sea_time(now);
        for (int i = 0; i < 400; ++i) {
            const int64_t sent = now + 2'000'000;
            const int64_t there = way(dice);
            const int64_t back = way(dice);
            while (now < sent + there + 10 + back) {
                now = std::min(sent + there + 10 + back, now + 16'667);
                const SeaTime shown = s.estimator.sea_time(now);
                ASSERT_GE(shown, last);
                last = shown;
                ASSERT_LE(std::abs(shown - s.truth(now)), s.estimator.error_bound_us(now))
                    << "drift " << drift << " round " << i;
            }
            s.exchange(sent, there, 10, back);
        }
    }
}

TEST(ClockEstimator, an_old_lucky_exchange_gives_way_in_time) {
    Simulation s;
    s.drift = 1e-4;
    int64_t now = s.hello(0, 10, 10);
    // All later ones are worse, but 100 s of drift weigh more than 2 ms of delay.
    for (int i = 1; i <= 50; ++i) now = s.exchange(i * 2'000'000, 1000, 0, 1000);
    EXPECT_LE(s.estimator.error_bound_us(now), 1001);
    EXPECT_LE(s.error_us(now), s.estimator.error_bound_us(now));
}

TEST(ClockEstimator, a_better_estimate_is_slewed_in) {
    Simulation s;
    int64_t now = s.hello(1'000'000, 64'000, 0);  // shown time is 32 ms off
    s.estimator.sea_time(now);
    EXPECT_EQ(s.error_us(now), 32'000);
    now = s.exchange(now + 50'000, 50, 0, 50);
    const SeaTime before = s.estimator.sea_time(now);
    const int64_t error_before = std::abs(before - s.truth(now));
    EXPECT_GT(error_before, 30'000);
    // 32 ms at 1 part in 64 take about 2 s.
    for (int i = 0; i < 130; ++i) s.estimator.sea_time(now + i * 16'667);
    EXPECT_EQ(s.error_us(now + 130 * 16'667), 0);
}

TEST(ClockEstimator, asked_every_microsecond_it_still_slews) {
    Simulation s;
    int64_t now = s.hello(1'000'000, 2000, 0);
    s.estimator.sea_time(now);
    now = s.exchange(now + 1000, 5, 0, 5);
    const int64_t before = s.error_us(now);
    SeaTime last = s.estimator.sea_time(now);
    for (int i = 1; i <= 70'000; ++i) {
        const SeaTime shown = s.estimator.sea_time(now + i);
        ASSERT_GE(shown, last);
        last = shown;
    }
    EXPECT_GT(before, 900);
    EXPECT_LE(s.error_us(now + 70'000), 1);
}

TEST(ClockEstimator, a_new_epoch_steps_at_once) {
    Simulation s;
    int64_t now = s.hello(1'000'000, 100, 100);
    s.estimator.sea_time(now);
    s.clock.epoch = 2;
    s.clock.start = SeaTime{-1'000'000'000};
    s.clock.monotonic_start_us = s.server_at(now);
    s.clock.rate_q16 = 2U << 16;
    now = s.exchange(now + 50'000, 100, 0, 100);
    EXPECT_EQ(s.error_us(now), 0);
    EXPECT_EQ(s.estimator.sea_time(now + 1000) - s.estimator.sea_time(now), 2000);
}

TEST(ClockEstimator, a_reconnect_to_the_same_world_does_not_step_back) {
    Simulation s;
    int64_t now = s.hello(1'000'000, 100, 100);
    const SeaTime shown = s.estimator.sea_time(now);
    now = s.hello(now + 1000, 0, 40'000) + 1;  // a bad first exchange: 20 ms behind the truth
    EXPECT_GE(s.estimator.sea_time(now), shown);
    EXPECT_LE(s.error_us(now), 1000);
}

TEST(ClockEstimator, another_world_starts_afresh) {
    Simulation s;
    int64_t now = s.hello(1'000'000, 100, 100);
    s.estimator.sea_time(now);
    ServerHello other;
    other.instance.bytes[3] = 9;
    other.clock.start = SeaTime{42};
    other.client_stamp_us = other.server_now_us = now;
    s.estimator.begin(other, now);
    EXPECT_EQ(s.estimator.sea_time(now), sea_time_at(other.clock, now));
}

TEST(ClockEstimator, after_sleep_it_jumps_forwards) {
    Simulation s;
    int64_t now = s.hello(1'000'000, 100, 100);
    s.estimator.sea_time(now);
    s.ahead_us += 3'600'000'000;  // our clock stood still for an hour
    for (int i = 0; i < 8; ++i) now = s.exchange(now + 1000, 100, 0, 100);
    EXPECT_EQ(s.error_us(now), 0);
}

}  // namespace
}  // namespace trochoid
