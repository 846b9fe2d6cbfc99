#include "server/net/answer_lane.hpp"

#include <gtest/gtest.h>

#include "protocol/codec/codec.hpp"
#include "server/net/control_lane.hpp"
#include "server/net/terrain_lane.hpp"

namespace trochoid {
namespace {

TEST(AnswerLanes, PiecesStayWithinAFrameEvenWithTheLongestNames) {
    BoxList list;
    list.sequence = 3;
    list.now = {77};
    for (uint32_t i = 1; i <= 1024; ++i) {
        BoxSummary box;
        box.box = {i};
        box.name = std::string(i % 65, 'n');
        list.boxes.push_back(box);
    }
    std::vector<BoxSummary> joined;
    const auto pieces = in_pieces(list);
    for (size_t i = 0; i < pieces.size(); ++i) {
        EXPECT_LE(encode(pieces[i]).size(), Limits{}.frame_to_client);
        const auto& piece = std::get<BoxList>(pieces[i]);
        EXPECT_EQ(piece.sequence, 3U);
        EXPECT_EQ(piece.now, SeaTime{77});
        EXPECT_EQ(piece.last, i + 1 == pieces.size());
        joined.insert(joined.end(), piece.boxes.begin(), piece.boxes.end());
    }
    EXPECT_EQ(joined, list.boxes);
}

TEST(AnswerLanes, RaysOfAllLengths) {
    RaysReply reply;
    for (size_t i = 0; i < 128; ++i) {
        WaveRay ray;
        ray.points.assign(i, {{1, 2}, ActionKind::recovered});
        reply.rays.push_back(ray);
    }
    size_t rays = 0;
    for (const ServerMessage& piece : in_pieces(reply)) {
        EXPECT_LE(encode(piece).size(), Limits{}.frame_to_client);
        rays += std::get<RaysReply>(piece).rays.size();
    }
    EXPECT_EQ(rays, 128U);
}

TEST(AnswerLanes, EmptyAnswersAreOnePiece) {
    const auto pieces = in_pieces(BoxList{});
    ASSERT_EQ(pieces.size(), 1U);
    EXPECT_TRUE(std::get<BoxList>(pieces[0]).last);
}

TEST(ControlLanes, BoundedByMessagesAndBytes) {
    ControlLane few(2);
    EXPECT_TRUE(few.push(Bytes(10)));
    EXPECT_TRUE(few.push(Bytes(10)));
    EXPECT_FALSE(few.push(Bytes(10)));
    uint64_t frames = 5;
    EXPECT_EQ(few.take_all(frames).size(), 20U);
    EXPECT_EQ(frames, 7U);
    EXPECT_TRUE(few.empty());
    ControlLane large(64);
    EXPECT_TRUE(large.push(Bytes(ControlLane::most_bytes)));
    EXPECT_FALSE(large.push(Bytes(1)));
}

TEST(TerrainLanes, SendsEachTileOnceWhateverIsWanted) {
    const auto never_changed = [](const TerrainTileKey&) { return 0U; };
    TerrainLane lane;
    lane.want({{1, 0, 0}, {0, 0, 0}}, never_changed);
    EXPECT_EQ(lane.take(), (TerrainTileKey{1, 0, 0}));
    lane.want({{1, 0, 0}, {0, 1, 0}}, never_changed);
    EXPECT_EQ(lane.take(), (TerrainTileKey{0, 1, 0}));
    EXPECT_TRUE(lane.idle());
    lane.want({{0, 0, 0}}, never_changed);
    EXPECT_EQ(lane.take(), (TerrainTileKey{0, 0, 0})) << "given up before it was sent, wanted again";
    EXPECT_EQ(lane.sent(), 3U);
}

TEST(TerrainLanes, WhatChangedIsSentAgainWantedOnesFirst) {
    TerrainLane lane;
    const auto old_ground = [](const TerrainTileKey&) { return 0U; };
    lane.want({{1, 0, 0}, {0, 0, 0}, {0, 1, 0}}, old_ground);
    while (lane.take()) {
    }
    const auto new_ground = [](const TerrainTileKey& key) { return key.x == 0 ? 2U : 0U; };
    lane.want({{0, 1, 0}, {0, 0, 0}}, new_ground);
    EXPECT_EQ(lane.take(), (TerrainTileKey{0, 0, 0}));
    EXPECT_EQ(lane.take(), (TerrainTileKey{1, 0, 0}))
        << "held by the client though the view does not call for it";
    EXPECT_TRUE(lane.idle());
    lane.want({{0, 1, 0}, {0, 0, 0}}, new_ground);
    EXPECT_TRUE(lane.idle());
    EXPECT_EQ(lane.sent(), 3U);
}

}  // namespace
}  // namespace trochoid
