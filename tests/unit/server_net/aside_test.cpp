// Results that are computed aside: who waits for what.
#include <chrono>
#include <thread>

#include "server/net/session_share.hpp"
#include "server/net/session_turns.hpp"
#include "tests/unit/server_net/server_fixture.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;

TEST(FairQueue, AddressesTakeTurnsAndEachIsInOrder) {
    FairQueue<int> queue;
    const PeerAddress many{false, false, 1};
    const PeerAddress few{false, false, 2};
    EXPECT_FALSE(queue.pop());
    for (int i = 0; i < 4; ++i) queue.push(many, i);
    queue.push(few, 100);
    queue.push(few, 101);
    EXPECT_EQ(queue.size(), 6U);
    std::vector<int> order;
    while (const auto next = queue.pop()) order.push_back(*next);
    EXPECT_EQ(order, (std::vector<int>{0, 100, 1, 101, 2, 3}));
    EXPECT_TRUE(queue.empty());
    queue.push(many, 7);
    EXPECT_EQ(queue.pop(), 7);
}

TEST(SessionShare, AFiftiethOfTheTimeAndTwoSecondsAtOnce) {
    SessionShare share;
    int64_t now_us = 1'000'000'000;
    EXPECT_TRUE(share.left(now_us));
    share.spend(SessionShare::full_us + 1000);
    EXPECT_FALSE(share.left(now_us));
    EXPECT_FALSE(share.left(now_us + 49'000));
    EXPECT_TRUE(share.left(now_us + 60'000));
    // However often it is asked.
    share.spend(10'000);
    for (int i = 0; i < 400'000; ++i)
        if (share.left(now_us += 1)) break;
    EXPECT_FALSE(share.left(now_us));
    EXPECT_TRUE(share.left(now_us + 200'000));
    share.spend(-1'000'000'000);
    EXPECT_TRUE(share.left(now_us + 1'000'000));
    share.spend(SessionShare::full_us);
    EXPECT_FALSE(share.left(now_us + 1'000'000)) << "no more than two seconds' worth is saved up";
}

class Aside : public ServerFixture {
protected:
    bool release() {
        return on_loop([this] { return sea.release_aside(); });
    }
    bool asked(uint64_t count) {
        for (int i = 0; i < 200 && sea.asked_aside < count; ++i) std::this_thread::sleep_for(milliseconds(5));
        return sea.asked_aside == count;
    }
};

TEST_F(Aside, WhileTheFirstResultIsComputedEverythingElseGoesOn) {
    sea.holds_aside = true;
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in()) << "the hello does not wait";
    ASSERT_TRUE(asked(1));
    client.send(ClockRequest{1, 17});
    const auto clock = client.wait_for<ClockReply>();
    ASSERT_TRUE(clock);
    EXPECT_EQ(clock->client_sent_us, 17);
    // The world changes, and the client looks elsewhere: both count after the first result.
    ViewState elsewhere = RawClient::usual_hello().view;
    elsewhere.position.x += to_lattice(5000);
    client.send(ViewUpdate{2, elsewhere});
    change_sea();
    EXPECT_FALSE(client.receive(milliseconds(200)));
    ASSERT_TRUE(release());
    const auto first = client.next_result();
    ASSERT_TRUE(first);
    EXPECT_EQ(first->result, 1U);
    EXPECT_EQ(first->base, 0U);
    ASSERT_TRUE(client.acknowledge(*first));
    const auto second = client.next_result();
    ASSERT_TRUE(second);
    EXPECT_EQ(second->base, 1U);
    EXPECT_EQ(hash_of(client.state()), hash_of(sea.state_for(elsewhere)));
    EXPECT_EQ(sea.asked_aside, 1U) << "whoever holds something and asks for little does not wait";
}

TEST_F(Aside, OneAtATimeAndAddressesTakeTurns) {
    sea.holds_aside = true;
    start();
    std::vector<std::unique_ptr<RawClient>> clients;
    for (int i = 0; i < 3; ++i) {
        clients.push_back(std::make_unique<RawClient>(port()));
        ASSERT_TRUE(clients.back()->log_in());
    }
    RawClient other(port(), 0, "::1");
    ASSERT_TRUE(other.log_in());
    ASSERT_TRUE(asked(1));
    std::this_thread::sleep_for(milliseconds(50));
    EXPECT_EQ(sea.asked_aside, 1U) << "one at a time";
    ASSERT_TRUE(release());
    EXPECT_TRUE(clients[0]->next_result());
    ASSERT_TRUE(asked(2));
    ASSERT_TRUE(release());
    EXPECT_TRUE(clients[1]->next_result());
    ASSERT_TRUE(asked(3));
    ASSERT_TRUE(release());
    EXPECT_TRUE(other.next_result()) << "before the third of the other address";
    ASSERT_TRUE(asked(4));
    ASSERT_TRUE(release());
    EXPECT_TRUE(clients[2]->next_result());
}

// Each of them alone asks for little; together they would have the io thread for 0.75 s.
TEST_F(Aside, AllTogetherTakeHalfTheThread) {
    start();
    std::vector<std::unique_ptr<RawClient>> clients;
    for (int i = 0; i < 30; ++i) {
        clients.push_back(std::make_unique<RawClient>(port()));
        ASSERT_TRUE(clients.back()->log_in());
        const auto first = clients.back()->next_result();
        ASSERT_TRUE(first);
        ASSERT_TRUE(clients.back()->acknowledge(*first));
    }
    ASSERT_TRUE(asked(30));
    sea.costs_us = 25'000;
    change_sea();
    for (const auto& client : clients) EXPECT_TRUE(client->next_result());
    EXPECT_GE(sea.asked_aside, 30 + 5U);
    EXPECT_LE(sea.asked_aside, 30 + 22U) << "eight are within what may be taken at once";
}

TEST_F(Aside, WhoHasLeftHoldsUpNobody) {
    sea.holds_aside = true;
    start();
    auto computed = std::make_unique<RawClient>(port());
    ASSERT_TRUE(computed->log_in());
    ASSERT_TRUE(asked(1));
    auto waiting = std::make_unique<RawClient>(port());
    ASSERT_TRUE(waiting->log_in());
    RawClient stays(port());
    ASSERT_TRUE(stays.log_in());
    computed.reset();
    waiting.reset();
    EXPECT_TRUE(ended_with(ErrorCode::client_closed, 2));
    ASSERT_TRUE(release());
    ASSERT_TRUE(asked(2)) << "nothing is computed for one that has left";
    ASSERT_TRUE(release());
    EXPECT_TRUE(stays.next_result());
}

TEST_F(Aside, AfterAResyncTheSnapshotIsComputedAside) {
    start();
    RawClient client(port());
    ASSERT_TRUE(client.log_in());
    const auto first = client.next_result();
    ASSERT_TRUE(first);
    EXPECT_EQ(sea.asked_aside, 1U);
    sea.holds_aside = true;
    client.send(Ack{first->result, first->state_hash ^ 1, 0, {}});
    ASSERT_TRUE(asked(2));
    ASSERT_TRUE(release());
    const auto snapshot = client.next_result();
    ASSERT_TRUE(snapshot);
    EXPECT_EQ(snapshot->base, 0U);
    EXPECT_EQ(snapshot->state_hash, hash_of(sea.state_for(RawClient::usual_hello().view)));
}

// One whose result is being computed, and one whose turn has not come.
TEST_F(Aside, WhoeverWaitsForItIsToldWhenTheServerShutsDown) {
    sea.holds_aside = true;
    start();
    RawClient first(port());
    RawClient second(port());
    ASSERT_TRUE(first.log_in() && second.log_in());
    ASSERT_TRUE(asked(1));
    std::promise<void> drained;
    loop.post([&] { sessions->drain([&] { drained.set_value(); }); });
    for (RawClient* client : {&first, &second}) {
        const auto goodbye = client->wait_for<Goodbye>(milliseconds(1000));
        ASSERT_TRUE(goodbye);
        EXPECT_EQ(goodbye->code, ErrorCode::shutting_down);
    }
    ASSERT_TRUE(release());
    first.disconnect();
    second.disconnect();
    EXPECT_EQ(drained.get_future().wait_for(milliseconds(1500)), std::future_status::ready);
    EXPECT_EQ(stats().results, 0U);
    EXPECT_EQ(sea.asked_aside, 1U) << "nothing is computed for those who leave";
}

}  // namespace
}  // namespace trochoid
