#include "tests/support/net/chaos_proxy.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "protocol/units/hash.hpp"
#include "tests/support/net/byte_peer.hpp"

namespace trochoid {
namespace {

using Bytes = std::vector<uint8_t>;
using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

Bytes noise(size_t count, uint64_t seed = 1) {
    Bytes bytes(count);
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(seed = splitmix64(seed));
    return bytes;
}

/// A server and a client with a proxy in between.
struct Pair {
    explicit Pair(const ChaosSchedule& schedule) : proxy(server.port(), schedule), client(proxy.port()) {
        accepted = server.accept();
    }
    BytePeer server;
    ChaosProxy proxy;
    BytePeer client;
    bool accepted = false;
};

ChaosSchedule with(const ConnectionFaults& faults) {
    ChaosSchedule schedule;
    schedule.always = faults;
    return schedule;
}

/// The record of the first connection once it is over.
ProxiedConnection over(const ChaosProxy& proxy) {
    for (int i = 0; i < 500 && !proxy.connections().at(0).over; ++i)
        std::this_thread::sleep_for(milliseconds(5));
    return proxy.connections().at(0);
}

TEST(ChaosProxy, without_faults_a_megabyte_passes_each_way_and_so_does_the_end) {
    Pair pair({});
    ASSERT_TRUE(pair.accepted);
    const Bytes up = noise(1'000'000, 1);
    const Bytes down = noise(1'000'000, 2);
    // One thread a peer; after its end the client still hears the server.
    std::thread asking([&] {
        pair.client.send(up);
        pair.client.finish();
    });
    EXPECT_EQ(pair.server.receive(1'000'001), up);
    asking.join();
    std::thread serving([&] {
        pair.server.send(down);
        pair.server.finish();
    });
    EXPECT_EQ(pair.client.receive(1'000'001), down);
    serving.join();
    EXPECT_EQ(pair.client.stream(), BytePeer::Stream::finished);
    EXPECT_EQ(pair.server.stream(), BytePeer::Stream::finished);
    const ProxiedConnection record = over(pair.proxy);
    EXPECT_TRUE(record.over);
    EXPECT_EQ(record.bytes_up, 1'000'000U);
    EXPECT_EQ(record.bytes_down, 1'000'000U);
    EXPECT_FALSE(record.cut);
}

TEST(ChaosProxy, an_echo_takes_the_delay_of_both_ways) {
    ConnectionFaults faults;
    faults.up.delay_us = 30'000;
    faults.down.delay_us = 50'000;
    Pair pair(with(faults));
    ASSERT_TRUE(pair.accepted);
    const auto begin = Clock::now();
    pair.client.send(noise(10));
    EXPECT_EQ(pair.server.receive(10), noise(10));
    const auto there = Clock::now();
    pair.server.send(noise(10, 2));
    EXPECT_EQ(pair.client.receive(10), noise(10, 2));
    EXPECT_GE(there - begin, milliseconds(30));
    EXPECT_GE(Clock::now() - there, milliseconds(50));
    EXPECT_LT(Clock::now() - begin, milliseconds(400));  // a busy machine
}

TEST(ChaosProxy, cuts_at_exactly_the_byte_by_reset_and_by_an_orderly_end) {
    for (const CutKind kind : {CutKind::reset, CutKind::finish})
        for (const uint64_t at : {0U, 1U, 5000U, 16'384U, 99'999U}) {
            ConnectionFaults faults;
            faults.down.cut = Cut{at, kind};
            Pair pair(with(faults));
            ASSERT_TRUE(pair.accepted);
            const Bytes sent = noise(100'000);
            pair.server.send(sent);
            const Bytes came = pair.client.receive(sent.size());
            // A reset takes with it what its receiver has not read yet.
            EXPECT_LE(came.size(), at);
            if (kind == CutKind::finish) {
                EXPECT_EQ(came.size(), at);
            }
            EXPECT_EQ(came, Bytes(sent.begin(), sent.begin() + static_cast<std::ptrdiff_t>(came.size())));
            EXPECT_EQ(pair.client.stream(),
                      kind == CutKind::reset ? BytePeer::Stream::reset : BytePeer::Stream::finished);
            pair.server.receive(1);
            EXPECT_NE(pair.server.stream(), BytePeer::Stream::open);
            EXPECT_EQ(over(pair.proxy).cut, kind);
        }
}

TEST(ChaosProxy, half_open_says_nothing_to_anybody) {
    ConnectionFaults faults;
    faults.up.cut = Cut{100, CutKind::silence};
    Pair pair(with(faults));
    ASSERT_TRUE(pair.accepted);
    pair.client.send(noise(200));
    EXPECT_EQ(pair.server.receive(200, milliseconds(300)).size(), 100U);
    EXPECT_EQ(pair.server.stream(), BytePeer::Stream::open);
    pair.server.send(noise(10));
    pair.server.hang_up();
    EXPECT_TRUE(pair.client.receive(10, milliseconds(200)).empty());
    EXPECT_EQ(pair.client.stream(), BytePeer::Stream::open);
}

TEST(ChaosProxy, stalls_at_the_byte_for_the_time) {
    ConnectionFaults faults;
    faults.down.stall = Stall{1000, 150'000};
    Pair pair(with(faults));
    ASSERT_TRUE(pair.accepted);
    const auto begin = Clock::now();
    pair.server.send(noise(3000));
    EXPECT_EQ(pair.client.receive(1000).size(), 1000U);
    EXPECT_LT(Clock::now() - begin, milliseconds(140));
    EXPECT_EQ(pair.client.receive(2000).size(), 2000U);
    EXPECT_GE(Clock::now() - begin, milliseconds(150));
}

TEST(ChaosProxy, a_reset_by_the_server_reaches_the_client_and_cut_all_ends_what_stands) {
    Pair pair({});
    ASSERT_TRUE(pair.accepted);
    pair.client.send(noise(100));
    std::this_thread::sleep_for(milliseconds(50));
    pair.server.hang_up();  // over unread bytes: a reset
    pair.client.receive(1);
    EXPECT_EQ(pair.client.stream(), BytePeer::Stream::reset);

    BytePeer second(pair.proxy.port());
    ASSERT_TRUE(pair.server.accept());
    pair.proxy.cut_all(CutKind::finish);
    second.receive(1);
    EXPECT_EQ(second.stream(), BytePeer::Stream::finished);
    EXPECT_EQ(pair.proxy.connections().size(), 2U);
}

TEST(ChaosProxy, leads_later_connections_elsewhere_under_another_schedule) {
    Pair pair({});
    BytePeer elsewhere;
    pair.proxy.lead_to(elsewhere.port());
    ConnectionFaults faults;
    faults.up.flips = {{2, 4}};
    pair.proxy.set(with(faults));
    BytePeer second(pair.proxy.port());
    ASSERT_TRUE(elsewhere.accept());
    second.send(Bytes{1, 2, 3});
    EXPECT_EQ(elsewhere.receive(3), (Bytes{1, 2, 7}));
}

}  // namespace
}  // namespace trochoid
