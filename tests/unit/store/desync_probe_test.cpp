#include "client/store/desync_probe.hpp"

#include <gtest/gtest.h>

#include "tests/support/probe_answer.hpp"

namespace trochoid {
namespace {

InterestState two_boxes() {
    InterestState state;
    for (uint32_t id = 1; id <= 2; ++id) {
        WaveTrainBox box;
        box.id = {id};
        box.first_train = {id * 10};
        WaveTrain train;
        train.kx = 40018 + static_cast<int32_t>(id);
        train.omega = 1613943558211ULL;
        train.amplitude = 1.0F;
        box.trains = {train, train};
        state.boxes.emplace(box.id, std::make_shared<const WaveTrainBox>(box));
    }
    for (int32_t x = 0; x < 5; ++x) {
        PatchDescriptor patch;
        patch.key = {16, x, -3};
        if (x != 2) patch.boxes = {{{1}, 2}, {{2}, 1}};
        state.patches.emplace(patch.key, patch);
    }
    return state;
}

Probe probe_at(std::vector<LatticePoint> points) {
    Probe probe;
    probe.sequence = 3;
    probe.result = 4;
    probe.time = {77'000'000};
    probe.points = std::move(points);
    return probe;
}

TEST(DesyncProbe, PointsLieInPatchesWithWavesAndFollowFromTheSeed) {
    const InterestState state = two_boxes();
    const auto points = probe_points(state, {}, 5, 200);
    ASSERT_EQ(points.size(), 200U);
    std::map<int32_t, int> hits;
    for (const LatticePoint p : points) {
        const PatchDescriptor* patch = patch_holding(state, p);
        ASSERT_NE(patch, nullptr);
        EXPECT_FALSE(patch->boxes.empty());
        ++hits[patch->key.x];
    }
    EXPECT_EQ(hits.size(), 4U);
    EXPECT_EQ(probe_points(state, {}, 5, 200), points);
    EXPECT_NE(probe_points(state, {}, 6, 200), points);
}

TEST(DesyncProbe, WithoutPatchesPointsLieInRegions) {
    const std::vector<SyncRegion> regions{{{1000, 2000}, 50}, {{world_bound, -world_bound}, 4000}};
    for (const LatticePoint p : probe_points({}, regions, 9, 100)) {
        const bool first = std::abs(p.x - 1000) <= 50 && std::abs(p.z - 2000) <= 50;
        const bool second = p.x >= world_bound - 4000 && p.x <= world_bound && p.z <= -world_bound + 4000 &&
                            p.z >= -world_bound;
        EXPECT_TRUE(first || second);
    }
    EXPECT_TRUE(probe_points({}, {}, 1, 4).empty());
}

TEST(DesyncProbe, EqualStatesHaveNoDifference) {
    const InterestState state = two_boxes();
    const Probe probe = probe_at(probe_points(state, {}, 1, 4));
    const auto finding = compare(answer_from(state, probe), probe, state);
    ASSERT_TRUE(finding);
    EXPECT_EQ(finding->compared, 4U);
    EXPECT_FALSE(finding->difference);
}

TEST(DesyncProbe, ADifferenceIsNamedByPatchBoxAndPart) {
    const InterestState right = two_boxes();
    InterestState wrong = right;
    auto box = std::make_shared<WaveTrainBox>(*right.boxes.at({1}));
    box->trains[1].phase ^= 1U << 31;
    wrong.boxes[{1}] = box;
    const Probe probe = probe_at(probe_points(right, {}, 1, 4));
    const auto finding = compare(answer_from(right, probe), probe, wrong);
    ASSERT_TRUE(finding);
    ASSERT_TRUE(finding->difference);
    const Desync& d = *finding->difference;
    EXPECT_EQ(d.box, BoxId{1});
    EXPECT_EQ(d.part, 1);
    EXPECT_EQ(d.at, probe.points[0]);
    EXPECT_EQ(d.patch, patch_holding(right, d.at)->key);
    EXPECT_EQ(d.result, 4U);
    EXPECT_EQ(d.time, probe.time);
    EXPECT_NE(d.expected, d.actual);
}

TEST(DesyncProbe, PointsThatAreNotAnsweredAreNotCompared) {
    const InterestState state = two_boxes();
    const Probe probe = probe_at(probe_points(state, {}, 1, 4));
    ProbeReply reply = answer_from(state, probe);
    reply.points.resize(2);
    const auto finding = compare(reply, probe, state);
    ASSERT_TRUE(finding);
    EXPECT_EQ(finding->compared, 2U);
}

TEST(DesyncProbe, AReplyToAnotherProbeIsABreach) {
    const InterestState state = two_boxes();
    const Probe probe = probe_at(probe_points(state, {}, 1, 4));
    ProbeReply other = answer_from(state, probe);
    other.result = 5;
    EXPECT_EQ(compare(other, probe, state).error().code, ErrorCode::value_out_of_range);
    other = answer_from(state, probe);
    other.time.us += 1;
    EXPECT_EQ(compare(other, probe, state).error().code, ErrorCode::value_out_of_range);
    other = answer_from(state, probe);
    other.points.emplace_back();
    EXPECT_EQ(compare(other, probe, state).error().code, ErrorCode::value_out_of_range);
}

}  // namespace
}  // namespace trochoid
