// Probes and what clients tell of differences, over a fake sea.
#include "protocol/model/probe_sum.hpp"
#include "tests/unit/server_net/server_fixture.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;

class Probing : public ServerFixture {
protected:
    static Probe probe_of(uint32_t result, std::vector<LatticePoint> points) {
        Probe probe;
        probe.sequence = 1;
        probe.result = result;
        probe.time = {5'000'000};
        probe.points = std::move(points);
        return probe;
    }
    const std::vector<LatticePoint> places{{100, 200}, {70'000, 3}, {-500'000'000, 12}};
};

TEST_F(Probing, AProbeIsAnsweredFromWhatTheClientWasSent) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.enter());
    client.send(probe_of(1, places));
    const auto reply = client.wait_for<ProbeReply>();
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->sequence, 1U);
    EXPECT_EQ(reply->result, 1U);
    EXPECT_EQ(reply->time, (SeaTime{5'000'000}));
    EXPECT_FALSE(reply->stale);
    ASSERT_EQ(reply->points.size(), places.size());
    size_t parts = 0;
    for (size_t i = 0; i < places.size(); ++i) {
        const PointSum ours = probe_sum(client.state(), {5'000'000}, places[i]);
        EXPECT_EQ(reply->points[i].sample, ours.sample);
        ASSERT_EQ(reply->points[i].parts.size(), ours.parts.size());
        for (size_t j = 0; j < ours.parts.size(); ++j)
            EXPECT_EQ(reply->points[i].parts[j].sum, ours.parts[j].sum);
        parts += ours.parts.size();
    }
    EXPECT_GT(parts, 0U);
    EXPECT_EQ(stats().probes, 1U);
}

TEST_F(Probing, ResultsThatAreNotTheLastOneAreStale) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.enter());
    change_sea();
    const auto second = client.next_result();
    ASSERT_TRUE(second);
    client.send(probe_of(1, places));
    const auto reply = client.wait_for<ProbeReply>();
    ASSERT_TRUE(reply);
    EXPECT_TRUE(reply->stale);
    EXPECT_TRUE(reply->points.empty());
    Probe ahead = probe_of(7, places);
    ahead.sequence = 2;
    client.send(ahead);
    const auto none = client.wait_for<ProbeReply>();
    ASSERT_TRUE(none);
    EXPECT_TRUE(none->stale);
    EXPECT_EQ(stats().stale_probes, 2U);
}

TEST_F(Probing, ADifferenceBringsASnapshotAndIsCountedByItsKind) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.enter());
    Desync desync;
    desync.sequence = 1;
    desync.result = 1;
    desync.at = places[0];
    desync.patch = {16, 0, 0};
    desync.box = {1};
    desync.part = 0;
    client.send(desync);
    const auto second = client.next_result();
    ASSERT_TRUE(second);
    EXPECT_EQ(second->result, 2U);
    EXPECT_EQ(second->base, 0U);
    EXPECT_EQ(stats().desyncs[PartKind::train], 1U);
    EXPECT_EQ(stats().resyncs, 0U) << "the hashes agreed";
    client.acknowledge(*second);
    // One that finds difference after difference costs a snapshot each: it is not heard again at once.
    desync.sequence = 2;
    client.send(desync);
    const auto goodbye = client.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::rate_limited);
    EXPECT_EQ(goodbye->offending_sequence, 2U);
}

TEST_F(Probing, ProbesAreRateLimitedAndTheSessionGoesOn) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.enter());
    size_t answered = 0;
    size_t refused = 0;
    for (uint32_t i = 1; i <= 30; ++i) {
        Probe probe = probe_of(1, std::vector<LatticePoint>(most_probe_points, places[0]));
        probe.sequence = i;
        client.send(probe);
    }
    while (answered + refused < 30) {
        const auto message = client.receive();
        ASSERT_TRUE(message) << answered << " answered, " << refused << " refused";
        if (std::holds_alternative<ProbeReply>(*message)) ++answered;
        if (const auto* reply = std::get_if<CommandReply>(&*message)) {
            EXPECT_EQ(reply->code, ErrorCode::rate_limited);
            ++refused;
        }
    }
    EXPECT_GE(answered, 6U);
    EXPECT_LE(answered, 12U);
    EXPECT_FALSE(client.closed());
}

TEST_F(Probing, Version2KnowsNoProbes) {
    start();
    for (const bool probes : {true, false}) {
        RawClient client(port());
        ClientHello hello = RawClient::usual_hello();
        hello.protocol_max = 2;
        ASSERT_TRUE(client.log_in(hello));
        if (probes) {
            client.send(probe_of(1, places));
        } else {
            Desync desync;
            desync.sequence = 1;
            desync.result = 1;
            client.send(desync);
        }
        const auto goodbye = client.wait_for<Goodbye>();
        ASSERT_TRUE(goodbye);
        EXPECT_EQ(goodbye->code, ErrorCode::unexpected_message);
    }
}

}  // namespace
}  // namespace trochoid
