// Sessions that go on with what an earlier one has left, over a fake sea.
#include "tests/unit/server_net/server_fixture.hpp"

namespace trochoid {
namespace {

class Resuming : public ServerFixture {
protected:
    /// A session up to its first result, cut then; what it leaves behind.
    ResumeState cut_session() {
        RawClient client(port());
        const auto hello = client.log_in();
        EXPECT_TRUE(hello);
        const auto result = client.next_result();
        EXPECT_TRUE(result);
        held = client.state();
        snapshot_bytes = client.bytes_received();
        client.disconnect();
        return {hello->instance, result->key, result->state_hash, result->key.log_position, 99};
    }
    static ClientHello hello_with(const ResumeState& claim) {
        ClientHello hello = RawClient::usual_hello();
        hello.resume = claim;
        return hello;
    }
    uint64_t verdicts(ResumeVerdict verdict) { return stats().resumes[verdict]; }

    InterestState held;
    uint64_t snapshot_bytes = 0;
};

TEST_F(Resuming, WhatIsHeldIsTheBaseOfTheNextResult) {
    sea.bulk = 3;
    start();
    const ResumeState claim = cut_session();
    RawClient client(port());
    client.hold(held);
    const auto hello = client.log_in(hello_with(claim));
    ASSERT_TRUE(hello);
    EXPECT_TRUE(hello->resumed);
    EXPECT_EQ(hello->capabilities, capability_probes | capability_resume);
    // Nothing has changed, and yet the client is told so.
    const auto second = client.next_result();
    ASSERT_TRUE(second);
    EXPECT_EQ(second->result, 2U);
    EXPECT_EQ(second->base, 1U);
    EXPECT_EQ(second->base_hash, claim.state_hash);
    EXPECT_EQ(second->state_hash, claim.state_hash);
    EXPECT_TRUE(second->change.empty());
    EXPECT_LT(client.bytes_received() * 5, snapshot_bytes);
    client.acknowledge(*second);
    change_sea();
    const auto third = client.next_result();
    ASSERT_TRUE(third);
    EXPECT_EQ(third->result, 3U);
    EXPECT_EQ(third->base, 2U);
    EXPECT_EQ(third->state_hash, hash_of(client.state()));
    EXPECT_EQ(verdicts(ResumeVerdict::resumed), 1U);
    EXPECT_EQ(stats().resyncs, 0U);
}

TEST_F(Resuming, OnlyWhatHasChangedMeanwhileComes) {
    start();
    const ResumeState claim = cut_session();
    RawClient client(port());
    client.hold(held);
    ClientHello hello = hello_with(claim);
    hello.view.position.x += int64_t{2} << 16;  // two patches on
    ASSERT_TRUE(client.log_in(hello));
    const auto second = client.next_result();
    ASSERT_TRUE(second);
    EXPECT_EQ(second->base, 1U);
    EXPECT_EQ(second->change.patches.size(), 2U);
    EXPECT_TRUE(second->change.boxes.empty());
    EXPECT_EQ(hash_of(client.state()), hash_of(sea.state_for(hello.view)));
}

TEST_F(Resuming, WhatCannotBeResumedBeginsWithASnapshot) {
    start();
    const ResumeState good = cut_session();
    const auto begins_anew = [&](const ClientHello& hello) {
        RawClient client(port());
        client.hold(held);
        const auto answer = client.log_in(hello);
        ASSERT_TRUE(answer);
        EXPECT_FALSE(answer->resumed);
        const auto first = client.next_result();
        ASSERT_TRUE(first);
        EXPECT_EQ(first->result, 1U);
        EXPECT_EQ(first->base, 0U);
        EXPECT_EQ(first->state_hash, hash_of(client.state()));
    };
    ResumeState claim = good;
    claim.state_hash ^= 1;
    begins_anew(hello_with(claim));
    EXPECT_EQ(verdicts(ResumeVerdict::other_state), 1U);
    claim = good;
    claim.instance.bytes[3] ^= 1;
    begins_anew(hello_with(claim));
    EXPECT_EQ(verdicts(ResumeVerdict::other_instance), 1U);
    EXPECT_EQ(sea.resumes_asked, 2U);
    EXPECT_EQ(stats().sessions_started, 3U) << "whatever it claims, its session begins";
}

// What no key may have is refused before the sea is asked.
TEST_F(Resuming, KeysBeyondTheLimitsCostNothing) {
    limits.sync_regions = 2;
    limits.patches = 300;
    start();
    ResumeState claim = cut_session();
    sea.resumes_asked = 0;
    claim.key.regions.assign(3, SyncRegion{{0, 0}, 1024});
    RawClient many(port());
    const auto answer = many.log_in(hello_with(claim));
    ASSERT_TRUE(answer);
    EXPECT_FALSE(answer->resumed);
    claim.key.regions.clear();
    claim.key.patch_limit = 301;
    RawClient wide(port());
    ASSERT_TRUE(wide.log_in(hello_with(claim)));
    EXPECT_EQ(sea.resumes_asked, 0U);
    EXPECT_EQ(verdicts(ResumeVerdict::no_such_key), 2U);
}

TEST_F(Resuming, Version2KnowsNoResume) {
    start();
    ClientHello hello = hello_with(cut_session());
    hello.protocol_max = 2;
    RawClient client(port());
    const auto answer = client.log_in(hello);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->protocol, 2U);
    EXPECT_FALSE(answer->resumed);
    EXPECT_EQ(sea.resumes_asked, 0U);
}

TEST_F(Resuming, AResumedStateThatTheClientThenDisownsIsSentAnew) {
    start();
    const ResumeState claim = cut_session();
    RawClient client(port());
    client.hold(held);
    ASSERT_TRUE(client.log_in(hello_with(claim)));
    const auto second = client.next_result();
    ASSERT_TRUE(second);
    client.send(Ack{2, 0, 0, {}});
    const auto third = client.next_result();
    ASSERT_TRUE(third);
    EXPECT_EQ(third->result, 3U);
    EXPECT_EQ(third->base, 0U);
    EXPECT_EQ(stats().resyncs, 1U);
}

TEST_F(Resuming, HowClientsSayThatTheirLastSessionEndedIsCounted) {
    start();
    ClientHello hello = RawClient::usual_hello();
    hello.last_code = ErrorCode::no_progress;
    RawClient client(port());
    ASSERT_TRUE(client.log_in(hello));
    EXPECT_EQ(stats().clients_ends[ErrorCode::no_progress], 1U);
}

TEST_F(Resuming, SessionsOfTwoServersHaveOtherNumbers) {
    start();
    RawClient client(port());
    const auto here = client.log_in();
    ASSERT_TRUE(here);
    const SessionServer other(loop, sea, limits);
    const Listener listener_there(loop, ListenAddresses{}, [&](std::unique_ptr<Transport> t) {
        const_cast<SessionServer&>(other).accept(std::move(t));
    });
    RawClient elsewhere(listener_there.port());
    const auto there = elsewhere.log_in();
    ASSERT_TRUE(there);
    EXPECT_NE(here->session, there->session);
    on_loop([&] {
        loop.stop();
        return 0;
    });
    thread.join();
}

}  // namespace
}  // namespace trochoid
