#include "server/net/state_lane.hpp"

#include <gtest/gtest.h>

#include "tests/unit/server_net/fake_sea.hpp"

namespace trochoid {
namespace {

class StateLaneRules : public testing::Test {
protected:
    // Begins a result for the fake sea's present state and writes all of it, `bytes` in total.
    Delta write_result(size_t bytes = 100) {
        MadeResult made = *sea.make_result({view, regions, nullptr, 0});
        const InterestDelta change = sea.change(*lane.base(), *made.state, made.key);
        lane.begin(std::move(made), change, 16384);
        Delta last;
        while (lane.writing()) {
            last = lane.take_piece();
            lane.wrote(last.last ? bytes : 0, last.last, now_us);
        }
        return last;
    }
    StateLane::Acknowledged ack(const Delta& result, uint64_t wrong = 0) {
        return lane.acknowledge(Ack{result.result, result.state_hash + wrong, 0, {}}, now_us);
    }

    FakeSea sea;
    ViewState view;
    std::vector<SyncRegion> regions;
    StateLane lane;
    int64_t now_us = 1'000'000;
};

TEST_F(StateLaneRules, SnapshotThenDeltasOnTheLastWritten) {
    const Delta first = write_result();
    EXPECT_EQ(first.base, 0U);
    ++sea.revision;
    const Delta second = write_result();
    EXPECT_EQ(second.base, 1U);
    EXPECT_EQ(second.base_hash, first.state_hash);
    ++sea.revision;
    const Delta third = write_result();  // no ack came: the base is what was written all the same
    EXPECT_EQ(third.base, 2U);
}

TEST_F(StateLaneRules, CreditIsSpentByBytesAndReturnedByAcks) {
    const Delta first = write_result(StateLane::window_bytes - 1);
    EXPECT_TRUE(lane.has_credit());
    lane.wrote(1, false, now_us);  // terrain counts too
    EXPECT_FALSE(lane.has_credit());
    EXPECT_EQ(ack(first), StateLane::Acknowledged::in_step);
    EXPECT_TRUE(lane.has_credit());
    EXPECT_EQ(lane.unacknowledged_bytes(), 1U);
}

TEST_F(StateLaneRules, CreditIsSpentByResultsToo) {
    std::vector<Delta> results;
    for (size_t i = 0; i < StateLane::window_results; ++i) {
        EXPECT_TRUE(lane.has_credit());
        ++sea.revision;
        results.push_back(write_result(1));
    }
    EXPECT_FALSE(lane.has_credit());
    EXPECT_EQ(ack(results.back()), StateLane::Acknowledged::in_step) << "one ack stands for all before it";
    EXPECT_TRUE(lane.has_credit());
}

TEST_F(StateLaneRules, MarkerAsksForAnAckOfTerrain) {
    EXPECT_FALSE(lane.marker_due());
    write_result();
    lane.wrote(StateLane::marker_bytes - 1, false, now_us);
    EXPECT_FALSE(lane.marker_due());
    lane.wrote(1, false, now_us);
    ASSERT_TRUE(lane.marker_due());
    lane.begin_marker({5});
    const Delta marker = lane.take_piece();
    EXPECT_TRUE(marker.last);
    EXPECT_TRUE(marker.change.empty());
    EXPECT_EQ(marker.base, 1U);
    EXPECT_EQ(marker.state_hash, marker.base_hash);
    lane.wrote(10, true, now_us);
    EXPECT_FALSE(lane.marker_due());
    EXPECT_EQ(ack(marker), StateLane::Acknowledged::in_step);
    EXPECT_EQ(lane.unacknowledged_bytes(), 0U);
}

TEST_F(StateLaneRules, AcksOfWhatWasNeverWrittenAndRepeatedOnes) {
    const Delta first = write_result();
    Delta future = first;
    future.result = 2;
    EXPECT_EQ(ack(future), StateLane::Acknowledged::never_written);
    EXPECT_EQ(ack(first), StateLane::Acknowledged::in_step);
    EXPECT_EQ(ack(first), StateLane::Acknowledged::superseded);
}

TEST_F(StateLaneRules, ResyncForgetsTheBaseAndWhatWasInFlight) {
    const Delta first = write_result(StateLane::window_bytes);
    ++sea.revision;
    const Delta second = write_result();
    EXPECT_EQ(ack(first, 1), StateLane::Acknowledged::out_of_step);
    lane.resync();
    EXPECT_TRUE(lane.has_credit()) << "the client passes over what is in flight";
    EXPECT_EQ(lane.key(), nullptr);
    EXPECT_EQ(ack(second, 1), StateLane::Acknowledged::superseded) << "written before the resync";
    const Delta snapshot = write_result();
    EXPECT_EQ(snapshot.base, 0U);
    EXPECT_EQ(snapshot.result, 3U);
    EXPECT_EQ(ack(snapshot), StateLane::Acknowledged::in_step);
}

TEST_F(StateLaneRules, ResyncInTheMiddleOfAResultStillWritesItWhole) {
    sea.patches = 1024;
    MadeResult made = *sea.make_result({view, regions, nullptr, 0});
    const InterestDelta change = sea.change(*lane.base(), *made.state, made.key);
    lane.begin(std::move(made), change, 4096);
    const Delta head = lane.take_piece();
    ASSERT_FALSE(head.last);
    lane.wrote(4096, false, now_us);
    // Piece 0 already shows that the base does not fit: an ack of it with another hash.
    EXPECT_EQ(lane.acknowledge(Ack{1, 0, 0, {}}, now_us), StateLane::Acknowledged::out_of_step);
    lane.resync();
    EXPECT_TRUE(lane.writing());
    uint16_t pieces = 1;
    while (lane.writing()) {
        const Delta piece = lane.take_piece();
        EXPECT_EQ(piece.piece, pieces++);
        EXPECT_EQ(piece.last, !lane.writing());
        lane.wrote(4096, piece.last, now_us);
    }
    EXPECT_EQ(write_result().base, 0U);
}

TEST_F(StateLaneRules, ALargeResultThatAResyncCutShortDoesNotHoldUpTheSnapshot) {
    const Delta first = write_result();
    ++sea.revision;
    MadeResult made = *sea.make_result({view, regions, nullptr, 0});
    const InterestDelta change = sea.change(*lane.base(), *made.state, made.key);
    lane.begin(std::move(made), change, 16384);
    EXPECT_EQ(ack(first, 1), StateLane::Acknowledged::out_of_step);
    lane.resync();
    Delta last;
    while (lane.writing()) {
        last = lane.take_piece();
        lane.wrote(2 * StateLane::window_bytes, last.last, now_us);
    }
    EXPECT_TRUE(lane.has_credit()) << "the client passes it by without an ack";
    EXPECT_EQ(ack(last), StateLane::Acknowledged::superseded) << "or with one that was on its way";
    EXPECT_EQ(write_result().base, 0U);
}

TEST_F(StateLaneRules, SlowTakerOfPatchesGetsNoMoreThanASecondsWorthAhead) {
    sea.patches = 200;
    const Delta first = write_result(10);
    EXPECT_EQ(lane.acknowledge(Ack{1, first.state_hash, 100, {}}, now_us), StateLane::Acknowledged::in_step);
    EXPECT_TRUE(lane.has_credit());
    ++sea.revision;
    write_result(10);
    EXPECT_FALSE(lane.has_credit()) << "200 patches in flight at 100 a second";
}

TEST_F(StateLaneRules, RoundTripIsMeasured) {
    EXPECT_EQ(lane.round_trip_us(), 0);
    const Delta first = write_result();
    now_us += 50'000;
    ack(first);
    EXPECT_EQ(lane.round_trip_us(), 50'000);
}

}  // namespace
}  // namespace trochoid
