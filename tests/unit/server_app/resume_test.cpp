// Clients that come back to the real sea: what they hold is computed again from its key, compared, and built on.
#include <fmt/format.h>

#include <chrono>

#include "protocol/codec/codec.hpp"
#include "protocol/wire/frame.hpp"
#include "server/interest/cull.hpp"
#include "server/interest/cull_key.hpp"
#include "tests/unit/server_app/real_server.hpp"

namespace trochoid {
namespace {

using std::chrono::steady_clock;

class ComingBack : public RealServer {
protected:
    /// The island's sea at rest in time, so that clients of the same view have the same key.
    void start_still() {
        start(island(), scene_with_wind());
        ASSERT_EQ(command({1, {}, false, SetRate{0}}).get().code, ErrorCode::none);
    }
    static ClientHello hello_over_the_island() {
        ClientHello hello = RawClient::usual_hello();
        hello.view.position = {to_lattice(-800), to_lattice(-300)};
        hello.view.altitude = static_cast<int32_t>(to_lattice(40));
        hello.regions = {{hello.view.position, static_cast<uint32_t>(to_lattice(1500))}};
        return hello;
    }
    /// What a client that holds this after that result says of it.
    ResumeState claim_of(const Delta& last, const InterestState& held) {
        ResumeState claim;
        claim.key = last.key;
        claim.state_hash = hash_of(held);
        claim.log_position = on_loop([this] { return authority->state()->log_position; });
        claim.log_hash = on_loop([this] { return authority->state()->log_hash; });
        return claim;
    }
    CommandReply wind(uint64_t seed) {
        StartWind more = wind_over_the_origin();
        more.seed = seed;
        more.trains = 64;
        return command({2, {}, false, more}).get();
    }
    /// Takes a result whole and gives its last piece; `bytes`: its frames', headers included.
    static std::optional<Delta> weigh(RawClient& client, size_t& bytes) {
        bytes = 0;
        while (auto piece = client.wait_for<Delta>()) {
            bytes += frame(encode(*piece)).size();
            if (piece->last) return piece;
        }
        return std::nullopt;
    }
    uint64_t verdicts(ResumeVerdict verdict) {
        return on_loop([this] { return sessions->stats(); }).resumes[verdict];
    }
    void begins_anew(const ResumeState& claim, ResumeVerdict verdict) {
        const uint64_t before = verdicts(verdict);
        ClientHello hello = hello_over_the_island();
        hello.resume = claim;
        RawClient client(listener->port());
        const auto began = steady_clock::now();
        const auto answer = client.log_in(hello);
        const auto took = steady_clock::now() - began;
        ASSERT_TRUE(answer);
        EXPECT_FALSE(answer->resumed);
        EXPECT_EQ(verdicts(verdict), before + 1) << name_of(verdict);
        EXPECT_LT(took, std::chrono::milliseconds(500)) << name_of(verdict);
        const auto first = client.next_result();
        ASSERT_TRUE(first);
        EXPECT_EQ(first->base, 0U);
        EXPECT_EQ(first->state_hash, hash_of(client.state()));
    }
};

// Cut in the middle of the frames of a result: on the last whole one it goes on, at a small part of a snapshot's price, and ends where
// one ends that was never cut.
TEST_F(ComingBack, CutAmongFramesItEndsWhereAnUncutClientDoes) {
    start_still();
    const ClientHello hello = hello_over_the_island();
    RawClient uncut(listener->port());
    RawClient cut(listener->port());
    ASSERT_TRUE(uncut.log_in(hello));
    ASSERT_TRUE(cut.log_in(hello));
    size_t snapshot_bytes = 0;
    const auto whole = weigh(cut, snapshot_bytes);
    const auto same = uncut.next_result();
    ASSERT_TRUE(whole && same);
    cut.acknowledge(*whole);
    uncut.acknowledge(*same);
    const InterestState held = cut.state();

    ASSERT_EQ(wind(7).code, ErrorCode::none);
    const auto piece = cut.wait_for<Delta>();
    ASSERT_TRUE(piece);
    EXPECT_FALSE(piece->last) << "the result has more than one frame";
    cut.disconnect();
    const ResumeState claim = claim_of(*whole, held);
    const CommandReply stop = command({3, {}, false, StopWind{{1}}}).get();
    ASSERT_EQ(stop.code, ErrorCode::none);

    RawClient back(listener->port());
    back.hold(held);
    ClientHello again = hello;
    again.resume = claim;
    const auto answer = back.log_in(again);
    ASSERT_TRUE(answer);
    ASSERT_TRUE(answer->resumed);
    const auto second = back.next_result();
    ASSERT_TRUE(second);
    EXPECT_EQ(second->base, 1U);
    EXPECT_EQ(second->base_hash, claim.state_hash);
    EXPECT_EQ(second->key.log_position, stop.log_position);
    EXPECT_EQ(second->state_hash, hash_of(back.state()));
    back.acknowledge(*second);
    std::optional<Delta> last;
    while (!last || last->key.log_position < stop.log_position) {
        last = uncut.next_result();
        ASSERT_TRUE(last);
        uncut.acknowledge(*last);
    }
    EXPECT_EQ(hash_of(uncut.state()), hash_of(back.state()));
    EXPECT_EQ(last->key, second->key);

    // With nothing new the price of coming back is a fraction of the snapshot.
    RawClient once_more(listener->port());
    once_more.hold(back.state());
    again.resume = claim_of(*second, back.state());
    ASSERT_TRUE(once_more.log_in(again));
    size_t resumed_bytes = 0;
    const auto third = weigh(once_more, resumed_bytes);
    ASSERT_TRUE(third);
    EXPECT_EQ(third->state_hash, second->state_hash);
    RecordProperty("snapshot_bytes", static_cast<int>(snapshot_bytes));
    RecordProperty("resumed_bytes", static_cast<int>(resumed_bytes));
    fmt::print("snapshot {} bytes, resumed {} bytes\n", snapshot_bytes, resumed_bytes);
    EXPECT_LT(resumed_bytes * 50, snapshot_bytes);
}

TEST_F(ComingBack, TheWorldAsOfItsKeyIsKeptForAWhile) {
    start_still();
    RawClient client(listener->port());
    ASSERT_TRUE(client.log_in(hello_over_the_island()));
    const auto result = client.next_result();
    ASSERT_TRUE(result);
    const InterestState held = client.state();
    const ResumeState claim = claim_of(*result, held);
    client.disconnect();
    StartShip ship;
    ship.at = {to_lattice(-1500), to_lattice(-1700)};
    for (int i = 0; i < 5; ++i) {
        ASSERT_EQ(command({2, {}, false, ship}).get().code, ErrorCode::none);
        RawClient back(listener->port());
        back.hold(held);
        ClientHello hello = hello_over_the_island();
        hello.resume = claim;
        const auto answer = back.log_in(hello);
        ASSERT_TRUE(answer);
        EXPECT_TRUE(answer->resumed) << i + 1 << " events later";
        const auto second = back.next_result();
        ASSERT_TRUE(second);
        EXPECT_EQ(second->state_hash, hash_of(back.state()));
    }
    for (int i = 0; i < 5; ++i) ASSERT_EQ(command({2, {}, false, ship}).get().code, ErrorCode::none);
    begins_anew(claim, ResumeVerdict::too_old);
}

TEST_F(ComingBack, FalseClaimsBeginWithASnapshotAndCostLittle) {
    start_still();
    RawClient client(listener->port());
    ASSERT_TRUE(client.log_in(hello_over_the_island()));
    const auto result = client.next_result();
    ASSERT_TRUE(result);
    const ResumeState good = claim_of(*result, client.state());
    client.disconnect();

    const auto with = [&](const auto& change) {
        ResumeState claim = good;
        change(claim);
        return claim;
    };
    begins_anew(with([](ResumeState& c) { c.instance.bytes[0] ^= 1; }), ResumeVerdict::other_instance);
    begins_anew(with([](ResumeState& c) { c.log_position.value += 1; }), ResumeVerdict::unknown_position);
    begins_anew(with([](ResumeState& c) { c.log_position.value = UINT64_MAX; }),
                ResumeVerdict::unknown_position);
    begins_anew(with([](ResumeState& c) { c.log_hash ^= 1; }), ResumeVerdict::other_history);
    begins_anew(with([](ResumeState& c) { c.key.log_position.value += 9; }), ResumeVerdict::unknown_position);
    begins_anew(with([](ResumeState& c) { c.state_hash ^= 1; }), ResumeVerdict::other_state);
    // Keys that would have the server look at half the world, or at a part of it endlessly finely.
    begins_anew(with([](ResumeState& c) { c.key.slack = UINT32_MAX; }), ResumeVerdict::no_such_key);
    begins_anew(with([](ResumeState& c) { c.key.slack_tangent = 1e6F; }), ResumeVerdict::no_such_key);
    begins_anew(with([](ResumeState& c) { c.key.error_in_force_px = 0.0F; }), ResumeVerdict::no_such_key);
    begins_anew(with([](ResumeState& c) { c.key.patch_limit += 1; }), ResumeVerdict::no_such_key);
    begins_anew(with([](ResumeState& c) { c.key.until = c.key.until + (int64_t{1} << 40); }),
                ResumeVerdict::no_such_key);
    begins_anew(with([](ResumeState& c) {
                    c.key.anchor.tan_half_width = c.key.anchor.tan_half_height = 1e6F;
                    c.key.slack_tangent = 0.15F;
                }),
                ResumeVerdict::no_such_key);
    begins_anew(with([](ResumeState& c) {
                    // Fits all rules of keys, but would come to far more patches than its own limit.
                    c.key.anchor.accepted_error_px = 0.1F;
                    c.key.error_in_force_px = 0.1F;
                    c.key.anchor.viewport_width = c.key.anchor.viewport_height = 16384;
                    c.key.anchor.patch_budget = c.key.patch_limit = 1;
                }),
                ResumeVerdict::no_such_key);
    EXPECT_EQ(verdicts(ResumeVerdict::resumed), 0U);
}

// The log's hash is of its bytes up to a position: none before it, and none that is not there.
TEST_F(ComingBack, TheLogSaysItsHashAtEveryPosition) {
    start_still();
    const auto at = [this](uint64_t position) {
        return on_loop([&] { return authority->log_hash_at({position}); });
    };
    EXPECT_EQ(at(0), empty_log_hash);
    const auto events = on_loop([this] { return log.read({0}, 10); });
    ASSERT_EQ(events.size(), 2U);
    EXPECT_EQ(at(1), events[0].log_hash);
    EXPECT_EQ(at(2), events[1].log_hash);
    EXPECT_EQ(at(3), std::nullopt);
}

// Sea time goes on later in a new epoch; results follow it, and what was promised stays promised.
TEST_F(ComingBack, SkippedTimeOpensAnEpoch) {
    start(nullptr, scene_with_wind());
    RawClient client(listener->port());
    ASSERT_TRUE(client.enter());
    const SeaTime promised = watermark();
    const SeaTime before = on_loop([this] { return authority->now(); });
    constexpr int64_t forward_us = 600 * microseconds_per_second;
    const CommandReply skipped = command({1, {}, false, SkipTime{forward_us}}).get();
    ASSERT_EQ(skipped.code, ErrorCode::none) << skipped.message;
    EXPECT_GE(skipped.effective, before + forward_us);
    EXPECT_GE(watermark(), promised + forward_us - 1'000'000);
    const auto second = client.next_result();
    ASSERT_TRUE(second);
    EXPECT_LE(second->key.from, skipped.effective);
    EXPECT_GE(second->key.until, skipped.effective + microseconds_per_second);
    client.send(ClockRequest{1, 0});
    const auto clock = client.wait_for<ClockReply>();
    ASSERT_TRUE(clock);
    EXPECT_EQ(clock->clock.epoch, 2U);
    EXPECT_GE(sea_time_at(clock->clock, clock->server_sent_us), before + forward_us);
    EXPECT_EQ(command({2, {}, false, SkipTime{0}}).get().code, ErrorCode::value_out_of_range);
    EXPECT_EQ(command({3, {}, false, SkipTime{longest_skip_us + 1}}).get().code,
              ErrorCode::value_out_of_range);
}

}  // namespace
}  // namespace trochoid
