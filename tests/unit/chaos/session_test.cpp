// The real client and the real server with a bad network in between.
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "client/app/ocean_session.hpp"
#include "tests/support/net/chaos_proxy.hpp"
#include "tests/support/net/server_process.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr const char* a_sea =
    "name = \"chaos\"\n[[wind]]\nname = \"wind\"\nspeed = 10\ntowards = 90\norigin = [-20000, 0]\nfetch_m = 60000\n"
    "width_m = 40000\nbegin_s = -86400\ntrains = 12\nseed = 3\n";

const std::vector<SyncRegion> the_region{
    {{to_lattice(100), to_lattice(-50)}, static_cast<uint32_t>(to_lattice(200))}};

SessionOptions options_for(uint16_t port) {
    SessionOptions options;
    options.server = {"127.0.0.1", port};
    options.software = "chaos test";
    options.view.altitude = 15 * lattice_per_metre;
    options.regions = the_region;
    return options;
}

/// The server's own answer in the region, and ours from what we hold, from the same log position.
void expect_the_servers_sea(OceanSession& session) {
    std::vector<LatticePoint> points;
    points.reserve(64);
    for (int i = 0; i < 64; ++i)
        points.push_back({to_lattice(100 + 3 * i % 70), to_lattice(-50 + 5 * i % 70)});
    auto answer = std::make_shared<std::promise<Result<SampleReply>>>();
    session.sample(session.sea_time_now(), points,
                   [answer](Result<SampleReply> reply) { answer->set_value(std::move(reply)); });
    auto future = answer->get_future();
    ASSERT_EQ(future.wait_for(seconds(10)), std::future_status::ready);
    const Result<SampleReply> reply = future.get();
    ASSERT_TRUE(reply) << reply.error().message;
    ASSERT_TRUE(session.wait_until([&] { return session.snapshot()->log_position == reply->log_position; },
                                   seconds(5)));
    const auto known = session.snapshot();
    ASSERT_EQ(known->regions, the_region);
    const SeaInstant instant(known->sea, reply->time);
    for (size_t i = 0; i < points.size(); ++i) EXPECT_EQ(instant.evaluate(points[i]), reply->samples[i]) << i;
}

bool serves(const OceanSession& session, const ViewState& view) {
    const CullKey& key = session.snapshot()->key;
    const double dx = to_metres(key.anchor.position.x - view.position.x);
    const double dz = to_metres(key.anchor.position.z - view.position.z);
    return dx * dx + dz * dz <= to_metres(key.slack) * to_metres(key.slack);
}

TEST(SessionOverChaos, holds_the_servers_sea_after_cuts_stalls_and_delays) {
    ServerProcess server(a_sea, {"--log-level", "warn"});
    ChaosSchedule schedule;
    schedule.seed = 2022;
    schedule.cuts = 900;
    schedule.stalls = 300;
    schedule.delays = 700;
    schedule.within = 12'000;
    schedule.longest_stall_us = 300'000;
    schedule.longest_delay_us = 60'000;
    ChaosProxy proxy(server.port(), schedule);
    OceanSession cut(options_for(proxy.port()));
    OceanSession whole(options_for(server.port()));
    ViewState view = options_for(0).view;
    // Resets and orderly ends, beside what the schedule brings: half-open connections take the client 10 s to see.
    for (int i = 0; i < 60; ++i) {
        view.position.x += to_lattice(25);
        cut.set_view(view);
        whole.set_view(view);
        if (i % 12 == 11) proxy.cut_all(i % 24 == 11 ? CutKind::reset : CutKind::finish);
        std::this_thread::sleep_for(milliseconds(60));
    }
    proxy.set({});
    proxy.cut_all(CutKind::reset);
    const auto settled = [&] {
        return cut.statistics().state == LinkState::live && cut.snapshot()->regions == the_region &&
               serves(cut, view) && serves(whole, view);
    };
    ASSERT_TRUE(cut.wait_until(settled, seconds(30))) << cut.statistics().sentence;
    expect_the_servers_sea(cut);
    expect_the_servers_sea(whole);
    EXPECT_EQ(whole.statistics().connections, 1U);
    EXPECT_GE(proxy.connections().size(), 3U);
    EXPECT_EQ(cut.statistics().store.resyncs, 0U) << "a delta did not fit what the client held";
}

TEST(SessionOverChaos, a_bit_turned_over_on_the_way_down_is_never_shown) {
    ServerProcess server(a_sea, {"--log-level", "warn"});
    ChaosProxy proxy(server.port(), {});
    OceanSession whole(options_for(server.port()));
    ASSERT_TRUE(whole.wait_until([&] { return whole.snapshot()->result > 0; }, seconds(10)));
    // Behind the hello, in the first result: whatever it hits is refused or hashes otherwise.
    for (const uint64_t at : {900U, 1100U, 1500U, 2001U, 2500U}) {
        ChaosSchedule schedule;
        schedule.always.down.flips = {{at, 0x10}};
        schedule.spared_from = 0;
        proxy.set(schedule);
        OceanSession session(options_for(proxy.port()));
        ASSERT_TRUE(session.wait_until(
            [&] {
                return session.statistics().connections > 0 ||
                       session.statistics().state == LinkState::waiting;
            },
            seconds(10)));
        proxy.set({});
        ASSERT_TRUE(
            session.wait_until([&] { return session.snapshot()->regions == the_region; }, seconds(20)))
            << at;
        expect_the_servers_sea(session);
    }
}

TEST(SessionOverChaos, another_server_takes_over_behind_the_same_address) {
    ServerProcess first(a_sea, {"--log-level", "warn"});
    ServerProcess second(a_sea, {"--log-level", "warn"});
    ChaosProxy proxy(first.port(), {});
    OceanSession session(options_for(proxy.port()));
    ASSERT_TRUE(session.wait_until([&] { return session.snapshot()->result > 0; }, seconds(10)));
    const WorldInstance before = session.hello()->instance;
    proxy.lead_to(second.port());
    first.kill();
    // Another world's life: nothing of the old one is kept.
    ASSERT_TRUE(session.wait_until(
        [&] { return session.hello()->instance != before && session.snapshot()->regions == the_region; },
        seconds(20)));
    expect_the_servers_sea(session);
}

}  // namespace
}  // namespace trochoid
