#include "client/app/ocean_session.hpp"

#include <gtest/gtest.h>

#include <future>

#include "protocol/model/self_check.hpp"
#include "protocol/wire/requirements.hpp"
#include "tests/support/net/raw_server.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;

SessionOptions options_for(const RawServer& server, bool reconnect = true) {
    SessionOptions options;
    options.server = {"127.0.0.1", server.port()};
    options.software = "test 1";
    options.regions = {{{10, 20}, 3000}};
    options.reconnect = reconnect;
    return options;
}

/// A result that holds nothing but its key.
Delta empty_result(uint32_t number, const std::vector<SyncRegion>& regions) {
    Delta d;
    d.result = number;
    d.last = true;
    d.state_hash = hash_of(InterestState{});
    d.key.regions = regions;
    d.key.until = {1};
    return d;
}

struct SessionTest : testing::Test {
    RawServer server;
    bool reaches(OceanSession& session, LinkState state, milliseconds patience = milliseconds(8000)) {
        return session.wait_until([&] { return session.statistics().state == state; }, patience);
    }
};

TEST_F(SessionTest, hello_result_and_the_known_answer_with_the_first_ack) {
    OceanSession session(options_for(server));
    const auto hello = server.log_in();
    ASSERT_TRUE(hello);
    EXPECT_EQ(hello->regions, (std::vector<SyncRegion>{{{10, 20}, 3000}}));
    server.send(empty_result(1, hello->regions));
    const auto first = server.wait_for<Ack>();
    ASSERT_TRUE(first);
    EXPECT_EQ(first->known_answer, reference_hash(11, 64));
    EXPECT_EQ(first->state_hash, hash_of(InterestState{}));
    Delta second = empty_result(2, hello->regions);
    second.base = 1;
    second.base_hash = hash_of(InterestState{});
    server.send(second);
    const auto next = server.wait_for<Ack>();
    ASSERT_TRUE(next);
    EXPECT_EQ(next->result, 2U);
    EXPECT_FALSE(next->known_answer);
    EXPECT_EQ(session.snapshot()->regions, hello->regions);
    const SessionStatistics s = session.statistics();
    EXPECT_EQ(s.state, LinkState::live);
    EXPECT_EQ(s.fidelity, Fidelity::exact);
    EXPECT_EQ(s.server_version, "raw server");
    EXPECT_EQ(s.store.results, 2U);
    EXPECT_GT(s.bytes_received, 0U);
}

TEST_F(SessionTest, the_clock_is_asked_in_a_burst_and_then_seldom) {
    OceanSession session(options_for(server));
    ASSERT_TRUE(server.log_in());
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 8; ++i) {
        const auto request = server.wait_for<ClockRequest>();
        ASSERT_TRUE(request) << i;
        ClockReply reply;
        reply.sequence = request->sequence;
        reply.client_sent_us = request->client_sent_us;
        reply.server_received_us = reply.server_sent_us = 5'000'000 + request->client_sent_us;
        server.send(reply);
    }
    const auto burst = std::chrono::steady_clock::now() - begin;
    EXPECT_GT(burst, milliseconds(250));
    EXPECT_LT(burst, milliseconds(1500));
    EXPECT_FALSE(server.receive(milliseconds(1000)));
    EXPECT_TRUE(server.wait_for<ClockRequest>(milliseconds(2500)));
    EXPECT_LT(session.statistics().clock_error_us, 100'000);
    EXPECT_GT(session.sea_time_now().us, 0);
}

TEST_F(SessionTest, an_event_makes_it_watch_the_clock) {
    OceanSession session(options_for(server));
    ASSERT_TRUE(server.log_in());
    while (server.wait_for<ClockRequest>(milliseconds(400))) {
    }
    Delta d = empty_result(1, {});
    d.key.log_position = {1};
    server.send(d);
    int requests = 0;
    while (server.wait_for<ClockRequest>(milliseconds(400))) ++requests;
    EXPECT_GE(requests, 5);
    EXPECT_LE(requests, 9);
}

TEST_F(SessionTest, views_go_out_on_change_only_and_ten_times_a_second_at_most) {
    OceanSession session(options_for(server));
    ASSERT_TRUE(server.log_in());
    ASSERT_TRUE(reaches(session, LinkState::live));
    ViewState view;
    const auto begin = std::chrono::steady_clock::now();
    int32_t step = 0;
    while (std::chrono::steady_clock::now() - begin < milliseconds(1000)) {
        view.position.x = ++step;
        session.set_view(view);
        session.set_view(view);
    }
    int updates = 0;
    int64_t last = 0;
    uint32_t sequence = 0;
    while (const auto update = server.wait_for<ViewUpdate>(milliseconds(300))) {
        ++updates;
        EXPECT_GT(update->view.position.x, last);
        EXPECT_GT(update->sequence, sequence);
        last = update->view.position.x;
        sequence = update->sequence;
    }
    EXPECT_GE(updates, 5);
    EXPECT_LE(updates, 12);
    EXPECT_EQ(last, step) << "the latest has to win";
}

TEST_F(SessionTest, regions_are_told_once) {
    OceanSession session(options_for(server));
    ASSERT_TRUE(server.log_in());
    ASSERT_TRUE(reaches(session, LinkState::live));
    const std::vector<SyncRegion> moved{{{500, 600}, 7000}};
    session.set_regions(moved);
    session.set_regions(moved);
    const auto told = server.wait_for<SyncRegions>();
    ASSERT_TRUE(told);
    EXPECT_EQ(told->regions, moved);
    EXPECT_FALSE(server.wait_for<SyncRegions>(milliseconds(300)));
}

TEST_F(SessionTest, questions_are_answered_by_sequence_refused_and_failed) {
    OceanSession session(options_for(server));
    ASSERT_TRUE(server.log_in());
    ASSERT_TRUE(reaches(session, LinkState::live));
    std::promise<Result<SampleReply>> samples;
    std::promise<Result<RaysReply>> rays;
    std::promise<Result<BoxList>> boxes;
    session.sample({5}, {{1, 2}}, [&](Result<SampleReply> r) { samples.set_value(std::move(r)); });
    session.rays({3}, [&](Result<RaysReply> r) { rays.set_value(std::move(r)); });
    session.list([&](Result<BoxList> r) { boxes.set_value(std::move(r)); });
    const auto asked = server.wait_for<SampleRequest>();
    const auto rays_asked = server.wait_for<RaysRequest>();
    ASSERT_TRUE(asked && rays_asked);
    EXPECT_EQ(asked->points, (std::vector<LatticePoint>{{1, 2}}));
    RaysReply piece;
    piece.sequence = rays_asked->sequence;
    piece.box = {3};
    piece.rays = {{{0, 0}, {5, 5}, {}}};
    piece.last = false;
    server.send(piece);
    CommandReply refusal;
    refusal.sequence = asked->sequence;
    refusal.code = ErrorCode::value_out_of_range;
    refusal.message = "no";
    server.send(refusal);
    piece.last = true;
    server.send(piece);
    const auto no = samples.get_future().get();
    ASSERT_FALSE(no);
    EXPECT_EQ(no.error().code, ErrorCode::value_out_of_range);
    const auto traced = rays.get_future().get();
    ASSERT_TRUE(traced);
    EXPECT_EQ(traced->rays.size(), 2U);
    server.hang_up();
    EXPECT_FALSE(boxes.get_future().get()) << "a question must not outlive its connection unanswered";
}

TEST_F(SessionTest, an_answer_to_no_question_is_a_breach) {
    OceanSession session(options_for(server, false));
    ASSERT_TRUE(server.log_in());
    CommandReply stray;
    stray.sequence = 999;
    server.send(stray);
    const auto goodbye = server.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::unexpected_message);
    server.hang_up();
    EXPECT_TRUE(reaches(session, LinkState::ended));
}

TEST_F(SessionTest, a_wrong_hash_asks_for_a_snapshot_and_goes_on) {
    OceanSession session(options_for(server));
    ASSERT_TRUE(server.log_in());
    Delta wrong = empty_result(1, {});
    wrong.state_hash ^= 1;
    server.send(wrong);
    const auto plea = server.wait_for<Ack>();
    ASSERT_TRUE(plea);
    EXPECT_EQ(plea->state_hash, 0U);
    server.send(empty_result(2, {}));
    const auto good = server.wait_for<Ack>();
    ASSERT_TRUE(good);
    EXPECT_EQ(good->state_hash, hash_of(InterestState{}));
    EXPECT_EQ(session.statistics().store.resyncs, 1U);
}

TEST_F(SessionTest, it_comes_back_and_keeps_what_it_knew) {
    OceanSession session(options_for(server));
    const auto hello = server.log_in();
    ASSERT_TRUE(hello);
    server.send(empty_result(1, hello->regions));
    ASSERT_TRUE(server.wait_for<Ack>());
    server.hang_up();
    ASSERT_TRUE(reaches(session, LinkState::waiting));
    EXPECT_NE(session.statistics().sentence.find("server gone"), std::string::npos);
    EXPECT_NE(session.statistics().sentence.find("trying again in"), std::string::npos);
    EXPECT_EQ(session.snapshot()->regions, hello->regions);
    const uint64_t before = session.statistics().bytes_received;
    session.set_regions({{{1, 1}, 100}});
    const auto again = server.log_in();
    ASSERT_TRUE(again);
    EXPECT_EQ(again->regions, (std::vector<SyncRegion>{{{1, 1}, 100}}));
    ASSERT_TRUE(reaches(session, LinkState::live));
    EXPECT_EQ(session.statistics().connections, 2U);
    EXPECT_GT(session.statistics().bytes_received, before);
    EXPECT_EQ(session.snapshot()->regions, hello->regions) << "until the first result of the new session";
}

TEST_F(SessionTest, a_goodbye_without_retry_is_the_end) {
    OceanSession session(options_for(server));
    ASSERT_TRUE(server.accept());
    server.receive();
    Goodbye goodbye;
    goodbye.code = ErrorCode::protocol_version;
    goodbye.message = "update the client";
    server.send(goodbye);
    ASSERT_TRUE(reaches(session, LinkState::ended));
    EXPECT_EQ(session.statistics().sentence, "the server says: update the client");
    server.hang_up();
    EXPECT_FALSE(server.accept(milliseconds(1200)));
}

// A client's own messages break R-125 where they do not ascend, a server's results R-134.
TEST_F(SessionTest, a_result_out_of_order_is_named_by_its_requirement) {
    OceanSession session(options_for(server));
    const auto hello = server.log_in();
    ASSERT_TRUE(hello);
    server.send(empty_result(2, hello->regions));
    const auto goodbye = server.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::sequence_not_monotone);
    EXPECT_EQ(goodbye->requirement, requirement::result_order);
}

TEST_F(SessionTest, a_tile_without_a_grid_is_named_by_its_requirement) {
    OceanSession session(options_for(server));
    ASSERT_TRUE(server.log_in());
    server.send(TerrainTiles{});
    const auto goodbye = server.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::unexpected_message);
    EXPECT_EQ(goodbye->requirement, 136U);
}

// Land that needs more look-up than this client has: nobody has broken the protocol, and trying again would come to the same.
TEST_F(SessionTest, a_limit_of_our_own_is_not_blamed_on_the_server) {
    OceanSession session(options_for(server));
    const auto hello = server.log_in();
    ASSERT_TRUE(hello);
    Delta far = empty_result(1, hello->regions);
    InterestState state;
    for (uint32_t field = 1; field <= 5; ++field)
        for (const int32_t place : {0, 2047}) {
            auto block = std::make_shared<LandBlock>();
            block->key = {place, place};
            block->gain.fill(unit_node_gain / 2);
            far.change.blocks.push_back({{field}, 15, block, hash_of(*block)});
        }
    apply(state, far.change);
    far.state_hash = hash_of(state);
    server.send(far);
    const auto goodbye = server.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::too_much_land);
    EXPECT_EQ(goodbye->requirement, 0U);
    server.hang_up();
    ASSERT_TRUE(reaches(session, LinkState::ended));
    const std::string sentence = session.statistics().sentence;
    EXPECT_NE(sentence.find("a limit of this client"), std::string::npos) << sentence;
    EXPECT_EQ(sentence.find("broke the protocol"), std::string::npos) << sentence;
    EXPECT_FALSE(server.accept(milliseconds(1200))) << "it would come to the same again";
}

TEST_F(SessionTest, a_goodbye_with_retry_is_heeded) {
    OceanSession session(options_for(server));
    ASSERT_TRUE(server.log_in());
    Goodbye goodbye;
    goodbye.code = ErrorCode::shutting_down;
    goodbye.message = "back soon";
    goodbye.retry = true;
    goodbye.retry_after_ms = 1500;
    server.send(goodbye);
    ASSERT_TRUE(reaches(session, LinkState::waiting));
    server.hang_up();
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_TRUE(server.accept());
    EXPECT_GT(std::chrono::steady_clock::now() - begin, milliseconds(1200));
}

TEST_F(SessionTest, going_says_goodbye) {
    {
        OceanSession session(options_for(server));
        ASSERT_TRUE(server.log_in());
        ASSERT_TRUE(reaches(session, LinkState::live));
    }
    EXPECT_TRUE(server.wait_for<Goodbye>());
    EXPECT_TRUE(server.ends());
}

TEST(OceanSession, nobody_there_without_reconnect) {
    SessionOptions options;
    {
        RawServer server;
        options = options_for(server, false);
    }
    OceanSession session(options);
    ASSERT_TRUE(session.wait_until([&] { return session.statistics().state == LinkState::ended; },
                                   milliseconds(5000)));
    EXPECT_NE(session.statistics().sentence.find("nothing listens at"), std::string::npos);
    std::promise<Result<BoxList>> list;
    session.list([&](Result<BoxList> r) { list.set_value(std::move(r)); });
    EXPECT_FALSE(list.get_future().get());
}

}  // namespace
}  // namespace trochoid
