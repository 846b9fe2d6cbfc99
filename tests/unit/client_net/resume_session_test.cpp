// Sessions that go on over a cut, and what they do when their sea is not the server's.
#include <gtest/gtest.h>

#include <functional>

#include "client/app/ocean_session.hpp"
#include "tests/support/net/raw_server.hpp"
#include "tests/support/probe_answer.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;

std::shared_ptr<const WaveTrainBox> box(uint32_t id, uint32_t phase = 0) {
    WaveTrainBox b;
    b.id = {id};
    b.first_train = {id * 10};
    b.begin = {-1'000'000'000};
    WaveTrain train;
    train.kx = 40018;
    train.kz = 100;
    train.omega = 1613943558211ULL;
    train.amplitude = 1.0F;
    train.phase = phase;
    b.trains = {train, train, train};
    b.trains[1].field = {5};
    b.noise = {0.1F, 40'000, 3, 12, 22, true, 77};
    return std::make_shared<const WaveTrainBox>(b);
}

FieldBlock block(int32_t x, int32_t z, int32_t shift) {
    auto b = std::make_shared<LandBlock>();
    b->key = {x, z};
    b->shift.fill(shift);
    b->gain.fill(20'000);
    FieldBlock f;
    f.field = {5};
    f.block = std::move(b);
    return f;
}

/// One patch of 32 m inside one land block, so that every probe meets all there is.
InterestState little_sea() {
    InterestState state;
    state.boxes[{3}] = box(3);
    state.boxes[{4}] = box(4, 1U << 30);
    FieldBlock land = block(0, 0, 100);
    land.content = hash_of(*land.block);
    state.blocks[{{5}, {0, 0}}] = land;
    PatchDescriptor patch;
    patch.key = {15, 2, 3};
    patch.boxes = {{{3}, 3}, {{4}, 3}};
    state.patches.emplace(patch.key, patch);
    return state;
}

Delta snapshot_of(const InterestState& state, uint32_t result) {
    Delta d;
    d.result = result;
    d.last = true;
    d.base_hash = hash_of(InterestState{});
    d.state_hash = hash_of(state);
    d.change = difference({}, state);
    d.key.until = {1};
    d.key.slack = 9000 + result;
    return d;
}

Delta step_to(const InterestState& before, const InterestState& after, uint32_t result) {
    Delta d;
    d.result = result;
    d.base = result - 1;
    d.base_hash = hash_of(before);
    d.state_hash = hash_of(after);
    d.last = true;
    d.change = difference(before, after);
    d.key.until = {1};
    d.key.slack = 9000 + result;
    return d;
}

struct ResumeSession : testing::Test {
    RawServer server;
    SessionOptions options() {
        SessionOptions o;
        o.server = {"127.0.0.1", server.port()};
        o.software = "test 1";
        o.fresh_token = [] { return std::string("fresh"); };
        return o;
    }
    static ServerHello with_probes() {
        ServerHello hello = RawServer::usual_hello();
        hello.capabilities = capability_probes | capability_resume;
        return hello;
    }
    void tell_clock(LogPosition position, uint64_t hash) {
        const auto request = server.wait_for<ClockRequest>();
        ASSERT_TRUE(request);
        ClockReply reply;
        reply.sequence = request->sequence;
        reply.client_sent_us = request->client_sent_us;
        reply.log_position = position;
        reply.log_hash = hash;
        server.send(reply);
    }
};

TEST_F(ResumeSession, AHelloAfterACutClaimsWhatWasWhole) {
    OceanSession session(options());
    ServerHello first_hello = RawServer::usual_hello();
    first_hello.ticket = {1, 2, 3};
    first_hello.ticket_life_ms = 600'000;
    const auto first = server.log_in(first_hello);
    ASSERT_TRUE(first);
    EXPECT_FALSE(first->resume);
    EXPECT_EQ(first->token, "fresh");
    EXPECT_TRUE(first->ticket.empty());
    EXPECT_EQ(first->last_code, ErrorCode::none);
    EXPECT_EQ(first->capabilities, capability_probes | capability_resume);
    const InterestState sea = little_sea();
    server.send(snapshot_of(sea, 1));
    ASSERT_TRUE(server.wait_for<Ack>());
    tell_clock({6}, 0xabcdef);
    // The next result is cut after the first of its pieces.
    Delta half = step_to(sea, {}, 2);
    half.last = false;
    half.change = {};
    half.change.removed_boxes = {{3}};
    server.send(half);
    while (server.wait_for<ClockRequest>(milliseconds(200))) {
    }
    server.hang_up();

    ServerHello again = RawServer::usual_hello();
    again.resumed = true;
    const auto second = server.log_in(again);
    ASSERT_TRUE(second);
    ASSERT_TRUE(second->resume);
    EXPECT_EQ(second->resume->instance, first_hello.instance);
    EXPECT_EQ(second->resume->state_hash, hash_of(sea));
    EXPECT_EQ(second->resume->key.slack, 9001U);
    EXPECT_EQ(second->resume->log_position, LogPosition{6});
    EXPECT_EQ(second->resume->log_hash, 0xabcdefU);
    EXPECT_EQ(second->ticket, first_hello.ticket);
    EXPECT_NE(second->last_code, ErrorCode::none);
    InterestState more = sea;
    more.boxes[{8}] = box(8);
    server.send(step_to(sea, more, 2));
    const auto ack = server.wait_for<Ack>();
    ASSERT_TRUE(ack);
    EXPECT_EQ(ack->result, 2U);
    EXPECT_EQ(ack->state_hash, hash_of(more));
    EXPECT_TRUE(ack->known_answer);
    const SessionStatistics s = session.statistics();
    EXPECT_EQ(s.store.resumed, 1U);
    EXPECT_EQ(s.store.resyncs, 0U);
    EXPECT_EQ(session.snapshot()->sea.boxes().size(), 3U);
}

TEST_F(ResumeSession, AServerThatDoesNotResumeSendsASnapshot) {
    OceanSession session(options());
    ASSERT_TRUE(server.log_in());
    server.send(snapshot_of(little_sea(), 1));
    ASSERT_TRUE(server.wait_for<Ack>());
    server.hang_up();
    const auto again = server.log_in();
    ASSERT_TRUE(again);
    EXPECT_TRUE(again->resume);
    EXPECT_EQ(again->resume->log_position, LogPosition{}) << "no clock reply has told of any";
    EXPECT_EQ(again->resume->log_hash, 0U);
    InterestState other;
    other.boxes[{9}] = box(9);
    server.send(snapshot_of(other, 1));
    const auto ack = server.wait_for<Ack>();
    ASSERT_TRUE(ack);
    EXPECT_EQ(ack->state_hash, hash_of(other));
    EXPECT_EQ(session.statistics().store.resumed, 0U);
}

TEST_F(ResumeSession, AnotherInstanceLeavesNothing) {
    OceanSession session(options());
    ASSERT_TRUE(server.log_in());
    server.send(snapshot_of(little_sea(), 1));
    ASSERT_TRUE(server.wait_for<Ack>());
    tell_clock({6}, 5);
    server.hang_up();
    ServerHello other = RawServer::usual_hello();
    other.instance.bytes[0] = 99;
    ASSERT_TRUE(server.log_in(other));
    ASSERT_TRUE(
        session.wait_until([&] { return session.snapshot()->interest->boxes.empty(); }, milliseconds(3000)));
    server.hang_up();
    const auto third = server.log_in(other);
    ASSERT_TRUE(third);
    EXPECT_FALSE(third->resume) << "nothing of the new life is whole yet";
}

TEST_F(ResumeSession, ResumedWithoutBeingAskedIsABreach) {
    SessionOptions once = options();
    once.reconnect = false;
    OceanSession session(once);
    ServerHello bold = RawServer::usual_hello();
    bold.resumed = true;
    ASSERT_TRUE(server.log_in(bold));
    const auto goodbye = server.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::unexpected_message);
}

TEST_F(ResumeSession, ATicketThatIsRefusedLeavesTheToken) {
    OceanSession session(options());
    ServerHello hello = RawServer::usual_hello();
    hello.ticket = {4};
    hello.ticket_life_ms = 600'000;
    ASSERT_TRUE(server.log_in(hello));
    server.hang_up();
    ASSERT_TRUE(server.accept());
    const auto shown = server.wait_for<ClientHello>();
    ASSERT_TRUE(shown);
    EXPECT_EQ(shown->ticket, hello.ticket);
    Goodbye no;
    no.code = ErrorCode::token_refused;
    no.message = "used before";
    server.send(no);
    server.hang_up();
    const auto third = server.log_in();
    ASSERT_TRUE(third) << "it tries again";
    EXPECT_TRUE(third->ticket.empty());
    EXPECT_EQ(third->token, "fresh");
}

TEST_F(ResumeSession, ServersOfVersion2AreNeverProbed) {
    OceanSession session(options());
    ServerHello old = with_probes();
    old.protocol = 2;
    ASSERT_TRUE(server.log_in(old));
    server.send(snapshot_of(little_sea(), 1));
    EXPECT_FALSE(server.wait_for<Probe>(milliseconds(600)));
}

TEST_F(ResumeSession, EqualSeasAreFoundEqual) {
    OceanSession session(options());
    ASSERT_TRUE(server.log_in(with_probes()));
    const InterestState sea = little_sea();
    server.send(snapshot_of(sea, 1));
    const auto probe = server.wait_for<Probe>();
    ASSERT_TRUE(probe);
    EXPECT_EQ(probe->result, 1U);
    EXPECT_EQ(probe->points.size(), 4U);
    for (const LatticePoint p : probe->points) EXPECT_NE(patch_holding(sea, p), nullptr);
    server.send(answer_from(sea, *probe));
    ASSERT_TRUE(
        session.wait_until([&] { return session.statistics().store.probed == 4; }, milliseconds(3000)));
    EXPECT_EQ(session.statistics().store.desyncs, 0U);
    EXPECT_FALSE(server.wait_for<Desync>(milliseconds(200)));
}

TEST_F(ResumeSession, AStaleProbeIsTriedAgainSoon) {
    OceanSession session(options());
    ASSERT_TRUE(server.log_in(with_probes()));
    const InterestState sea = little_sea();
    server.send(snapshot_of(sea, 1));
    const auto probe = server.wait_for<Probe>();
    ASSERT_TRUE(probe);
    ProbeReply stale;
    stale.sequence = probe->sequence;
    stale.result = probe->result;
    stale.time = probe->time;
    stale.stale = true;
    server.send(stale);
    const auto again = server.wait_for<Probe>(milliseconds(3000));
    ASSERT_TRUE(again);
    EXPECT_NE(again->points, probe->points);
    EXPECT_EQ(session.statistics().store.probed, 0U);
}

/// A way in which what the client was told differs from what the server has, and the part where that first counts.
struct Fault {
    const char* name;
    std::function<void(InterestState& told)> make;
    BoxId box;
    uint16_t part;
};

class Desyncs : public ResumeSession, public testing::WithParamInterface<Fault> {};

// The client's sea is another one though its hash is the one it was told: the probe finds where, both sides know of it, and a snapshot
// heals it.
TEST_P(Desyncs, AreLocatedToldAndHealed) {
    const InterestState right = little_sea();
    InterestState told = right;
    GetParam().make(told);
    OceanSession session(options());
    ASSERT_TRUE(server.log_in(with_probes()));
    server.send(snapshot_of(told, 1));
    const auto probe = server.wait_for<Probe>();
    ASSERT_TRUE(probe);
    server.send(answer_from(right, *probe));
    const auto desync = server.wait_for<Desync>();
    ASSERT_TRUE(desync);
    EXPECT_EQ(desync->result, 1U);
    EXPECT_EQ(desync->patch, (PatchKey{15, 2, 3}));
    EXPECT_EQ(desync->box, GetParam().box);
    EXPECT_EQ(desync->part, GetParam().part);
    EXPECT_EQ(desync->at, probe->points[0]);
    EXPECT_NE(desync->expected, desync->actual);
    // A delta that was under way is passed by; the snapshot counts.
    InterestState more = told;
    more.boxes[{8}] = box(8);
    server.send(step_to(told, more, 2));
    server.send(snapshot_of(right, 3));
    const auto ack = server.wait_for<Ack>();
    ASSERT_TRUE(ack);
    EXPECT_EQ(ack->result, 3U);
    EXPECT_EQ(ack->state_hash, hash_of(right));
    EXPECT_EQ(session.statistics().store.desyncs, 1U);
    EXPECT_EQ(session.statistics().store.resyncs, 0U);
    EXPECT_EQ(hash_of(*session.snapshot()->interest), hash_of(right));
}

INSTANTIATE_TEST_SUITE_P(Kinds, Desyncs,
                         testing::Values(Fault{"OneBitOfATrain",
                                               [](InterestState& s) {
                                                   auto wrong =
                                                       std::make_shared<WaveTrainBox>(*s.boxes.at({4}));
                                                   wrong->trains[2].phase ^= 1U << 18;
                                                   s.boxes[{4}] = wrong;
                                               },
                                               {4},
                                               2},
                                         Fault{"ALandBlock",
                                               [](InterestState& s) {
                                                   FieldBlock wrong = block(0, 0, 101);
                                                   wrong.content = hash_of(*wrong.block);
                                                   s.blocks[{{5}, {0, 0}}] = wrong;
                                               },
                                               {3},
                                               1},
                                         Fault{"TheSeedOfANoise",
                                               [](InterestState& s) {
                                                   auto wrong =
                                                       std::make_shared<WaveTrainBox>(*s.boxes.at({3}));
                                                   wrong->noise.seed ^= 1;
                                                   s.boxes[{3}] = wrong;
                                               },
                                               {3},
                                               noise_part}),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace trochoid
