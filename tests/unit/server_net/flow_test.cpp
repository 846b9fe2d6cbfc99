#include <chrono>

#include "tests/unit/server_net/server_fixture.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;

// What a test lets pass for the server to have done all that it will.
constexpr milliseconds settle{300};

class Flow : public ServerFixture {
protected:
    static ViewState view_at(int64_t metres) {
        ViewState view = RawClient::usual_hello().view;
        view.position.x = to_lattice(static_cast<double>(metres));
        return view;
    }
};

TEST_F(Flow, ClientThatDoesNotReadCostsABoundedAmountAndIsCurrentAfterwards) {
    sea.bulk = 12;
    start();
    RawClient client(port(), 4096);
    ASSERT_TRUE(client.log_in());
    for (int i = 0; i < 60; ++i) {
        change_sea();
        std::this_thread::sleep_for(milliseconds(10));
    }
    const ServerStats stalled = stats();
    const uint64_t one_result = 1024 * 64;  // generous
    EXPECT_LE(stalled.state_bytes, StateLane::window_bytes + one_result);
    EXPECT_LE(sea.results_made, 6U) << "results must not be made for a client that takes none";

    // It reads and acknowledges again: current after what its kernel held plus one result.
    uint32_t results = 0;
    const uint64_t target = hash_of(sea.state_for(RawClient::usual_hello().view));
    while (hash_of(client.state()) != target) {
        const auto result = client.next_result();
        ASSERT_TRUE(result) << "after " << results;
        ASSERT_EQ(result->state_hash, hash_of(client.state()));
        ASSERT_TRUE(client.acknowledge(*result));
        ++results;
    }
    EXPECT_LE(results, 5U) << "superseded seas must not be sent";
    EXPECT_EQ(stats().resyncs, 0U);
}

TEST_F(Flow, StalledClientDoesNotHoldUpOthers) {
    sea.bulk = 12;
    start();
    RawClient stalled(port(), 4096);
    ASSERT_TRUE(stalled.log_in());
    RawClient good(port());
    ASSERT_TRUE(good.log_in());
    for (int i = 0; i < 10; ++i) {
        const auto result = good.next_result(milliseconds(1000));
        ASSERT_TRUE(result) << i;
        good.acknowledge(*result);
        change_sea();
    }
}

TEST_F(Flow, NothingIsBegunBeyondTheWindowWithoutAnAck) {
    sea.bulk = 12;
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    uint64_t bytes = 0;
    for (int i = 0; i < 40; ++i) {  // it reads, but says nothing
        change_sea();
        while (client.receive(milliseconds(10))) bytes = client.bytes_received();
    }
    EXPECT_LE(bytes, StateLane::window_bytes + 1024 * 64);
    EXPECT_LT(stats().results, 10U);
}

TEST_F(Flow, WrongHashIsAnsweredWithASnapshot) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    const auto first = client.next_result();
    ASSERT_TRUE(first);
    client.send(Ack{first->result, first->state_hash + 1, 0, {}});
    const auto second = client.next_result();
    ASSERT_TRUE(second);
    EXPECT_EQ(second->base, 0U);
    EXPECT_EQ(second->result, 2U);
    EXPECT_EQ(second->state_hash, first->state_hash);
    EXPECT_EQ(hash_of(client.state()), second->state_hash);
    EXPECT_EQ(stats().resyncs, 1U);
    client.acknowledge(*second);
    EXPECT_FALSE(client.receive(settle)) << "in step again: nothing to say";
}

TEST_F(Flow, ClientThatNeverAgreesIsToldGoodbye) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    int snapshots = 0;
    while (const auto result = client.next_result(milliseconds(1000))) {
        ++snapshots;
        client.send(Ack{result->result, 1, 0, {}});
    }
    EXPECT_EQ(snapshots, 5);
    EXPECT_TRUE(client.ends());
    client.disconnect();
    EXPECT_TRUE(ended_with(ErrorCode::base_mismatch, 1));
}

TEST_F(Flow, LatestViewWinsAndViewsAreConsideredAtMostTenTimesASecond) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.enter());
    std::this_thread::sleep_for(milliseconds(150));
    const uint64_t made = sea.results_made;
    for (uint32_t i = 1; i <= 25; ++i) client.send(ViewUpdate{i, view_at(int64_t{i} * 100)});
    const uint64_t target = hash_of(sea.state_for(view_at(2500)));
    const auto begun = std::chrono::steady_clock::now();
    while (hash_of(client.state()) != target) {
        const auto result = client.next_result();
        ASSERT_TRUE(result);
        client.acknowledge(*result);
    }
    EXPECT_LT(std::chrono::steady_clock::now() - begun, milliseconds(600));
    EXPECT_LE(sea.results_made - made, 3U);
    EXPECT_GE(stats().views_superseded, 22U);
}

TEST_F(Flow, RegionsAreTakenAtOnce) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.enter());
    client.send(SyncRegions{1, {SyncRegion{{1024, 2048}, 4096}}});
    const auto second = client.next_result();
    ASSERT_TRUE(second);
    ASSERT_EQ(second->key.regions.size(), 1U);
    EXPECT_EQ(second->key.regions[0].radius, 4096U);
}

TEST_F(Flow, AnswersThatPileUpEndTheSession) {
    start();
    RawClient client(port(), 2048);
    ASSERT_TRUE(client.log_in());
    for (uint32_t i = 1; i <= 900; ++i)
        if (!client.send(ClockRequest{i, 0})) break;
    std::this_thread::sleep_for(settle);
    const auto goodbye = client.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye) << "it reads again within the two seconds";
    EXPECT_EQ(goodbye->code, ErrorCode::queue_overflow);
    EXPECT_TRUE(client.ends());
    client.disconnect();
    EXPECT_TRUE(ended_with(ErrorCode::queue_overflow, 1));
}

TEST_F(Flow, NoProgressEndsStalledAndSilentClients) {
    limits.no_progress_ms = 400;
    sea.patches = 1024;
    start();
    RawClient stalled(port(), 2048);
    ASSERT_TRUE(stalled.log_in());
    RawClient silent(port());
    ASSERT_TRUE(silent.log_in());
    RawClient good(port());
    ASSERT_TRUE(good.log_in());
    // The stalled one still talks, but takes nothing; the good one does both.
    const auto until = std::chrono::steady_clock::now() + milliseconds(600);
    for (uint32_t i = 1; std::chrono::steady_clock::now() < until; ++i) {
        change_sea();
        stalled.send(ClockRequest{i, 0});
        if (const auto result = good.next_result(milliseconds(100))) good.acknowledge(*result);
        std::this_thread::sleep_for(milliseconds(20));
    }
    const auto goodbye = silent.wait_for<Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::no_progress);
    silent.disconnect();
    good.send(ClockRequest{1, 0});
    EXPECT_TRUE(good.wait_for<ClockReply>());
    stalled.disconnect();
    EXPECT_TRUE(ended_with(ErrorCode::no_progress, 2));
}

TEST_F(Flow, ClientsOwnGoodbyeIsRecorded) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    client.send(Goodbye{ErrorCode::client_closed, "done", false, 0, 0, 0});
    EXPECT_TRUE(client.ends());
    EXPECT_TRUE(ended_with(ErrorCode::client_closed, 1));
}

// What is begun is written whole first; a client that reads again within the two seconds hears why it ends.
TEST_F(Flow, AShutdownsGoodbyeComesBehindTheFrameThatIsBegun) {
    sea.bulk = 12;
    start();
    RawClient client(port(), 4096);
    ASSERT_TRUE(client.log_in());
    std::this_thread::sleep_for(settle);
    std::promise<void> drained;
    loop.post([&] { sessions->drain([&] { drained.set_value(); }); });
    std::this_thread::sleep_for(milliseconds(500));
    const auto goodbye = client.wait_for<Goodbye>(milliseconds(1000));
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->code, ErrorCode::shutting_down);
    EXPECT_TRUE(client.ends());
    client.disconnect();
    EXPECT_EQ(drained.get_future().wait_for(milliseconds(1500)), std::future_status::ready);
}

}  // namespace
}  // namespace trochoid
