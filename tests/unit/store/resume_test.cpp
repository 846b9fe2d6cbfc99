// A store over the end of one session and the beginning of the next.
#include <gtest/gtest.h>

#include "client/store/client_store.hpp"

namespace trochoid {
namespace {

std::shared_ptr<const WaveTrainBox> box(uint32_t id, float amplitude = 1.0F) {
    WaveTrainBox b;
    b.id = {id};
    b.first_train = {id * 10};
    WaveTrain train;
    train.kx = 40018;
    train.omega = 1613943558211ULL;
    train.amplitude = amplitude;
    train.field = {7};
    b.trains = {train};
    return std::make_shared<const WaveTrainBox>(b);
}

FieldBlock block(int32_t x, uint16_t gain) {
    auto b = std::make_shared<LandBlock>();
    b->key = {x, 0};
    b->gain.fill(gain);
    FieldBlock f;
    f.field = {7};
    f.block = std::move(b);
    return f;
}

PatchDescriptor patch(int32_t x) {
    PatchDescriptor p;
    p.key = {16, x, 0};
    p.boxes = {{{1}, 1}};
    return p;
}

ServerHello hello(bool resumed, uint8_t world = 1) {
    ServerHello h;
    h.session = 1;
    h.instance.bytes[0] = world;
    h.resumed = resumed;
    return h;
}

/// The next result over what the client should hold then.
struct Next {
    InterestState told;
    uint32_t result = 0;
    std::vector<Delta> pieces(const std::vector<InterestDelta>& changes) {
        std::vector<Delta> list;
        const uint64_t base_hash = hash_of(told);
        for (const InterestDelta& change : changes) {
            apply(told, change);
            Delta d;
            d.result = result + 1;
            d.piece = static_cast<uint16_t>(list.size());
            d.base = result;
            d.base_hash = base_hash;
            d.key.log_position = {result + 1};
            d.key.slack = 100 + result;
            d.change = change;
            list.push_back(d);
        }
        list.back().last = true;
        list.back().state_hash = hash_of(told);
        ++result;
        return list;
    }
};

struct Resume : testing::Test {
    ClientStore store;
    Next server;
    void take(const std::vector<Delta>& pieces) {
        for (const Delta& piece : pieces) {
            const auto ack = store.apply(piece);
            ASSERT_TRUE(ack) << ack.error().message;
            if (piece.last) {
                ASSERT_TRUE(*ack);
                EXPECT_EQ((*ack)->state_hash, hash_of(server.told));
            }
        }
    }
    void SetUp() override {
        store.begin(hello(false));
        take(server.pieces({{{box(1), box(2)}, {}, {block(0, 9000)}, {}, {patch(0), patch(1)}, {}}}));
    }
};

TEST_F(Resume, NothingIsClaimedBeforeAResultIsWhole) {
    ClientStore empty;
    EXPECT_FALSE(empty.resume_state());
    empty.begin(hello(false));
    EXPECT_FALSE(empty.resume_state());
    Next other;
    const auto pieces = other.pieces({{{box(1)}, {}, {}, {}, {}, {}}, {{box(2)}, {}, {}, {}, {}, {}}});
    ASSERT_TRUE(empty.apply(pieces[0]));
    EXPECT_FALSE(empty.resume_state());
    ASSERT_TRUE(empty.apply(pieces[1]));
    ASSERT_TRUE(empty.resume_state());
    EXPECT_EQ(empty.resume_state()->state_hash, hash_of(other.told));
}

TEST_F(Resume, ACutResultLeavesTheLastWholeOne) {
    const InterestState held = server.told;
    const uint64_t held_hash = hash_of(held);
    // Half of the next result comes: a box goes, land changes, a patch is new.
    Next lost = server;
    const auto pieces =
        lost.pieces({{{}, {{2}}, {block(0, 5000)}, {}, {}, {}}, {{}, {}, {}, {}, {patch(2)}, {}}});
    ASSERT_TRUE(store.apply(pieces[0]));
    const auto claim = store.resume_state();
    ASSERT_TRUE(claim);
    EXPECT_EQ(claim->state_hash, held_hash);
    EXPECT_EQ(claim->key.slack, 100U);
    EXPECT_EQ(claim->instance, hello(true).instance);

    store.begin(hello(true));
    EXPECT_EQ(store.counters().resumed, 1U);
    EXPECT_EQ(store.snapshot()->result, 1U);
    EXPECT_EQ(hash_of(*store.snapshot()->interest), held_hash);
    // The new session's result 2 builds on it.
    server.result = 1;
    take(server.pieces({{{box(3)}, {}, {}, {}, {patch(5)}, {}}}));
    EXPECT_EQ(store.counters().resyncs, 0U);
    EXPECT_EQ(store.snapshot()->interest->boxes.size(), 3U);
    // The land is what it was: the lost piece has left nothing in the prepared sea.
    InterestState twin = server.told;
    ClientStore fresh;
    fresh.begin(hello(false));
    Next all;
    const InterestDelta snapshot = difference({}, twin);
    for (const Delta& piece : all.pieces({snapshot})) ASSERT_TRUE(fresh.apply(piece));
    for (int64_t x = 0; x < 600'000; x += 70'001) {
        const auto sample = [x](const ClientStore& s) {
            return SeaInstant(s.snapshot()->sea, {5'000'000}).evaluate({x, 3});
        };
        EXPECT_EQ(sample(store), sample(fresh));
    }
}

TEST_F(Resume, ASnapshotThatWasCutLosesNothingEither) {
    const uint64_t held_hash = hash_of(server.told);
    store.begin(hello(false));
    Next anew;
    const auto pieces = anew.pieces({{{box(9)}, {}, {}, {}, {}, {}}, {{}, {}, {}, {}, {patch(2)}, {}}});
    ASSERT_TRUE(store.apply(pieces[0]));
    ASSERT_TRUE(store.resume_state());
    EXPECT_EQ(store.resume_state()->state_hash, held_hash);
    store.begin(hello(true));
    server.result = 1;
    take(server.pieces({{{box(4)}, {}, {}, {}, {}, {}}}));
    EXPECT_EQ(store.snapshot()->sea.boxes().size(), 3U);
}

TEST_F(Resume, WithoutResumingASnapshotFollows) {
    store.begin(hello(false));
    EXPECT_TRUE(store.resume_state()) << "until something newer is whole";
    EXPECT_EQ(store.snapshot()->result, 0U);
    Next anew;
    for (const Delta& piece : anew.pieces({{{box(5)}, {}, {}, {}, {}, {}}})) ASSERT_TRUE(store.apply(piece));
    EXPECT_EQ(store.snapshot()->interest->boxes.size(), 1U);
    EXPECT_EQ(store.counters().resumed, 0U);
}

TEST_F(Resume, AnotherInstanceDropsAll) {
    store.begin(hello(false, 2));
    EXPECT_FALSE(store.resume_state());
    EXPECT_TRUE(store.snapshot()->interest->boxes.empty());
}

// A server that goes on with what we do not hold is found out by its next result.
TEST_F(Resume, ResumedWithoutGroundAsksForASnapshot) {
    store.begin(hello(true, 2));
    Next bold = server;
    bold.result = 1;
    const auto pieces = bold.pieces({{{box(6)}, {}, {}, {}, {}, {}}});
    const auto ack = store.apply(pieces[0]);
    ASSERT_TRUE(ack);
    ASSERT_TRUE(*ack);
    EXPECT_EQ((*ack)->state_hash, 0U);
    EXPECT_EQ(store.counters().resyncs, 1U);
}

TEST_F(Resume, WhatIsDistrustedIsNotGoneOnWith) {
    store.distrust();
    EXPECT_EQ(store.counters().desyncs, 1U);
    EXPECT_FALSE(store.resume_state());
    // What was under way passes by, without an ack.
    for (const Delta& piece : server.pieces({{{box(3)}, {}, {}, {}, {}, {}}})) {
        const auto ack = store.apply(piece);
        ASSERT_TRUE(ack);
        EXPECT_FALSE(*ack);
    }
    EXPECT_EQ(store.counters().passed_by, 1U);
    auto anew = server.pieces({difference({}, server.told)});
    anew[0].base = 0;
    anew[0].base_hash = hash_of(InterestState{});
    const auto ack = store.apply(anew[0]);
    ASSERT_TRUE(ack);
    ASSERT_TRUE(*ack);
    EXPECT_EQ((*ack)->state_hash, hash_of(server.told));
    ASSERT_TRUE(store.resume_state());
    EXPECT_EQ(store.resume_state()->state_hash, hash_of(server.told));
}

// Another node may have read less of the log. What it has still to hear of may take effect before the first node's watermark.
TEST_F(Resume, AWatermarkIsOfTheLogThatWasRead) {
    store.confirm({5000}, {1});
    ASSERT_EQ(store.snapshot()->watermark, SeaTime{5000});
    const auto snapshot_at = [&](uint64_t position, int64_t watermark) {
        store.begin(hello(false));
        EXPECT_EQ(store.snapshot()->log_position, LogPosition{1}) << "what is shown until then is the old";
        Next anew;
        auto pieces = anew.pieces({{{box(5)}, {}, {}, {}, {}, {}}});
        pieces[0].key.log_position = {position};
        pieces[0].watermark = {watermark};
        EXPECT_TRUE(store.apply(pieces[0]));
    };
    snapshot_at(1, 3000);
    EXPECT_EQ(store.snapshot()->watermark, SeaTime{5000}) << "the same log: both hold";
    snapshot_at(0, 4000);
    EXPECT_EQ(store.snapshot()->watermark, SeaTime{4000})
        << "an earlier sea is confirmed as far as its node says";
    store.confirm({4500}, {0});
    EXPECT_EQ(store.snapshot()->watermark, SeaTime{4500});
}

}  // namespace
}  // namespace trochoid
