#include "tests/support/net/chaos_link.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

using Bytes = std::vector<uint8_t>;

Bytes noise(size_t count, uint64_t seed = 1) {
    Bytes bytes(count);
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(seed = splitmix64(seed));
    return bytes;
}

/// A link with a clock of its own.
struct TimedLink {
    explicit TimedLink(const LinkFaults& faults, uint64_t seed = 1, int64_t back_us = 0)
        : link(faults, seed, back_us) {}
    ChaosLink link;
    int64_t now = 0;
    Bytes out;
    std::vector<int64_t> at;  // of each byte
    std::optional<CutKind> cut;
    bool ended = false;

    void take(size_t most = 16384) {
        const ChaosLink::Out some = link.take(now, most);
        out.insert(out.end(), some.bytes.begin(), some.bytes.end());
        at.resize(out.size(), now);
        if (some.cut) cut = some.cut;
        ended = ended || some.ended;
        if (some.bytes.size() == most && !some.cut) take(most);
    }
    /// Until nothing more would come.
    void finish() {
        take();
        for (int64_t next = link.next_us(now); next != INT64_MAX; next = link.next_us(now)) {
            ASSERT_GT(next, now) << "it asks for a moment that is past";
            now = next;
            take();
        }
    }
};

TEST(ChaosLink, without_faults_everything_comes_out_at_once_and_in_order) {
    TimedLink run({});
    const Bytes sent = noise(100'000);
    run.link.put(std::span(sent).first(70'001), 0);
    run.link.put(std::span(sent).subspan(70'001), 0);
    run.link.end(0);
    run.finish();
    EXPECT_EQ(run.out, sent);
    EXPECT_TRUE(run.ended);
    EXPECT_EQ(run.now, 0);
}

TEST(ChaosLink, each_byte_is_delayed_by_the_delay_and_at_most_the_jitter_and_none_overtakes) {
    LinkFaults faults;
    faults.delay_us = 1000;
    faults.jitter_us = 500;
    TimedLink run(faults);
    const Bytes sent = noise(200);
    bool varied = false;
    std::vector<int64_t> put_at;
    for (size_t i = 0; i < sent.size(); ++i) {
        while (run.link.next_us(run.now) <= static_cast<int64_t>(i) * 100) {
            run.now = run.link.next_us(run.now);
            run.take();
        }
        run.now = static_cast<int64_t>(i) * 100;
        run.link.put(std::span(sent).subspan(i, 1), run.now);
        put_at.push_back(run.now);
    }
    run.finish();
    ASSERT_EQ(run.out, sent);
    for (size_t i = 0; i < sent.size(); ++i) {
        EXPECT_GE(run.at[i] - put_at[i], 1000);
        EXPECT_LE(run.at[i] - put_at[i], 1500);
        varied = varied || run.at[i] - put_at[i] != run.at[0] - put_at[0];
    }
    EXPECT_TRUE(varied);
}

TEST(ChaosLink, the_rate_holds) {
    LinkFaults faults;
    faults.bytes_per_second = 100'000;
    TimedLink run(faults);
    const Bytes sent = noise(144'800);
    run.link.put(sent, 0);
    run.finish();
    EXPECT_EQ(run.out, sent);
    EXPECT_NEAR(static_cast<double>(run.now), 1.448e6, 100.0);
    for (size_t i = 0; i < sent.size(); i += 1000)
        EXPECT_GE(run.at[i] + 1, static_cast<int64_t>(i) * 10 - 15'000) << i;
}

TEST(ChaosLink, slow_start_doubles_what_is_under_way_each_round_trip) {
    LinkFaults faults;
    faults.delay_us = 25'000;
    faults.first_window = 14'600;
    TimedLink run(faults, 1, 25'000);
    const Bytes sent = noise(100'000);
    run.link.put(sent, 0);
    run.finish();
    ASSERT_EQ(run.out, sent);
    const auto by = [&](int64_t until) {
        return static_cast<size_t>(std::upper_bound(run.at.begin(), run.at.end(), until) - run.at.begin());
    };
    EXPECT_EQ(by(24'999), 0U);
    EXPECT_EQ(by(25'000), 14'480U);  // ten segments
    EXPECT_EQ(by(74'999), 14'480U);
    EXPECT_EQ(by(75'000), 14'480U + 28'960U);  // twenty more
    EXPECT_EQ(by(125'000), 100'000U);
}

TEST(ChaosLink, a_stall_begins_at_its_byte_and_ends_in_time) {
    LinkFaults faults;
    faults.stall = Stall{777, 40'000};
    TimedLink run(faults);
    const Bytes sent = noise(2000);
    run.link.put(sent, 0);
    run.finish();
    ASSERT_EQ(run.out, sent);
    EXPECT_EQ(run.at[776], 0);
    EXPECT_EQ(run.at[777], 40'000);
    EXPECT_EQ(run.at[1999], 40'000);
}

TEST(ChaosLink, a_cut_comes_after_exactly_its_byte_wherever_pieces_end) {
    const Bytes sent = noise(40'000);
    for (const uint64_t at : {0U, 1U, 1447U, 1448U, 16'384U, 16'385U, 39'999U, 40'000U}) {
        LinkFaults faults;
        faults.cut = Cut{at, CutKind::finish};
        TimedLink run(faults);
        run.link.put(std::span(sent).first(20'000), 0);
        run.link.put(std::span(sent).subspan(20'000), 0);
        run.finish();
        EXPECT_EQ(run.out.size(), at);
        EXPECT_EQ(run.cut, CutKind::finish) << at;
        EXPECT_FALSE(run.ended);
        run.link.put(sent, 0);
        EXPECT_TRUE(run.link.take(1'000'000, 1000).bytes.empty());
    }
}

TEST(ChaosLink, flips_hit_their_bytes_alone) {
    LinkFaults faults;
    faults.flips = {{0, 1}, {16'384, 0x80}, {19'999, 0xFF}};
    TimedLink run(faults);
    Bytes sent = noise(20'000);
    run.link.put(sent, 0);
    run.finish();
    sent[0] ^= 1;
    sent[16'384] ^= 0x80;
    sent[19'999] ^= 0xFF;
    EXPECT_EQ(run.out, sent);
}

TEST(ChaosLink, a_reader_that_takes_little_at_a_time_gets_it_all) {
    LinkFaults faults;
    faults.delay_us = 10;
    TimedLink run(faults);
    const Bytes sent = noise(5000);
    run.link.put(sent, 0);
    run.link.end(0);
    run.now = 10;
    run.take(7);
    EXPECT_EQ(run.out, sent);
    EXPECT_TRUE(run.ended);
}

TEST(ChaosSchedule, faults_follow_from_seed_and_number_and_come_as_often_as_asked) {
    ChaosSchedule schedule;
    schedule.seed = 42;
    schedule.stalls = 50;
    schedule.cuts = 200;
    schedule.flips = 10;
    schedule.delays = 500;
    schedule.longest_delay_us = 1000;
    schedule.longest_stall_us = 1000;
    schedule.within = 5000;
    schedule.spared_from = 10'000;
    int stalls = 0;
    int cuts = 0;
    int flips = 0;
    int delays = 0;
    std::array<int, 3> kinds{};
    for (uint64_t i = 0; i < 10'000; ++i) {
        const ConnectionFaults faults = faults_of(schedule, i);
        EXPECT_EQ(faults, faults_of(schedule, i));
        for (const LinkFaults* link : {&faults.up, &faults.down}) {
            stalls += link->stall.has_value();
            flips += static_cast<int>(link->flips.size());
            if (!link->cut) continue;
            ++cuts;
            ++kinds.at(static_cast<size_t>(link->cut->kind));
            EXPECT_LT(link->cut->at, 5000U);
        }
        delays += faults.up.delay_us + faults.down.delay_us > 0;
    }
    EXPECT_NEAR(stalls, 500, 90);
    EXPECT_NEAR(cuts, 2000, 160);
    EXPECT_NEAR(flips, 100, 40);
    EXPECT_NEAR(delays, 5000, 200);
    const int third = cuts / 3;
    for (const int kind : kinds) EXPECT_NEAR(kind, third, 90);
    EXPECT_EQ(faults_of(schedule, 10'000), ConnectionFaults{});
    ChaosSchedule other = schedule;
    other.seed = 43;
    int same = 0;
    for (uint64_t i = 0; i < 100; ++i) same += faults_of(schedule, i) == faults_of(other, i);
    EXPECT_LT(same, 60);
}

}  // namespace
}  // namespace trochoid
