#include <array>
#include <bit>

#include "tests/unit/server_app/real_server.hpp"

namespace trochoid {
namespace {

using Bits = std::array<uint32_t, sizeof(SurfaceSample) / 4>;

/// Of land and open water, near and far, in no order, some asked twice.
std::vector<LatticePoint> points_everywhere(size_t count) {
    std::vector<LatticePoint> points{{0, 0}, {0, 0}, {world_bound, -world_bound}, {-world_bound, 77}};
    for (uint64_t i = points.size(); i < count; ++i)
        points.push_back({static_cast<int64_t>(i * 2654435761U % 8'000'000) - 4'000'000,
                          static_cast<int64_t>(i * 40503U * 977U % 8'000'000) - 4'000'000});
    return points;
}

// The fast path answers requests; what it says is the reference's word, signs of zeros included.
TEST_F(RealServer, SamplesAreTheReferencesBits) {
    start(island(), scene_with_wind());
    uint32_t sequence = 0;
    size_t moved = 0;
    for (const size_t count : {size_t{4}, size_t{65}, size_t{240}})
        for (const int64_t seconds : {-30, 600, 315'360'000}) {
            const SampleRequest request{
                ++sequence, {seconds * microseconds_per_second}, points_everywhere(count)};
            const Result<SampleReply> reply = on_loop([&] { return sea->sample(request); });
            ASSERT_TRUE(reply);
            EXPECT_EQ(reply->sequence, sequence);
            EXPECT_EQ(reply->time, request.time);
            ASSERT_EQ(reply->samples.size(), count);
            const SeaInstant reference(on_loop([this] { return authority->state(); })->sea, request.time);
            for (size_t i = 0; i < count; ++i) {
                const SurfaceSample wanted = reference.evaluate(request.points[i]);
                ASSERT_EQ(std::bit_cast<Bits>(reply->samples[i]), std::bit_cast<Bits>(wanted))
                    << seconds << " s, point " << i << " of " << count;
                moved += wanted.ay != 0.0F ? 1U : 0U;
            }
        }
    EXPECT_GT(moved, 100U) << "there are waves to compare";
}

TEST_F(RealServer, ARequestWithoutPointsIsAnsweredWithoutSamples) {
    start(nullptr, scene_with_wind());
    const Result<SampleReply> reply = on_loop([this] {
        return sea->sample({9, {5 * microseconds_per_second}, {}});
    });
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->sequence, 9U);
    EXPECT_TRUE(reply->samples.empty());
}

}  // namespace
}  // namespace trochoid
