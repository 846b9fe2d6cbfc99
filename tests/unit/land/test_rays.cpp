#include <gtest/gtest.h>

#include <cmath>

#include "server/land/land_trace.hpp"
#include "tests/unit/land/coasts.hpp"

namespace trochoid {
namespace {

TerrainGrid with_island() {
    return coast(385, 15, 60, [](double x, double z) {
        return std::clamp((600.0 - std::hypot(x, z)) / 12.0, -60.0, 40.0);
    });
}

TEST(Rays, ActionPointsComeInOrderOverAnIsland) {
    const TerrainGrid terrain = with_island();
    WaveTrainBox b = box(0.0, 10000.0, 8000.0);
    b.trains = {train(0.0, 80.0, 0.5), train(10.0, 20.0, 0.1)};
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    ASSERT_EQ(land.rays.size(), 128U);
    const WaveRay& ray = land.rays[64];
    EXPECT_EQ(ray.start.x, b.origin.x);
    EXPECT_EQ(ray.end.x, b.origin.x + b.length);
    ASSERT_EQ(ray.points.size(), 4U);
    const ActionKind kinds[] = {ActionKind::shoaling_starts, ActionKind::blocked, ActionKind::water_again,
                                ActionKind::recovered};
    // Half a wave length deep is 480 m off the shore; full height 2000 m behind it.
    const double places[] = {-1080.0, -600.0, 600.0, 2600.0};
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(ray.points[i].kind, kinds[i]);
        EXPECT_NEAR(to_metres(ray.points[i].at.x), places[i], 50.0);
        EXPECT_EQ(ray.points[i].at.z, ray.start.z);
    }
    // A ray that passes 3.9 km off the island meets nothing.
    EXPECT_TRUE(land.rays.front().points.empty());
}

TEST(Rays, LieAlongTheBoxEvenlySpaced) {
    const TerrainGrid terrain = with_island();
    WaveTrainBox b = box(30.0, 6000.0, 1000.0);
    b.trains = {train(30.0, 60.0, 0.5)};
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    ASSERT_EQ(land.rays.size(), 31U);
    for (size_t i = 0; i < land.rays.size(); ++i) {
        const BoxPosition start = box_position(b, instant_of(b, b.begin), land.rays[i].start);
        const BoxPosition end = box_position(b, instant_of(b, b.begin), land.rays[i].end);
        const double v = static_cast<double>(b.width) * (2.0 * static_cast<double>(i) + 1.0) / 62.0;
        EXPECT_NEAR(static_cast<double>(start.u), 0.0, 3.0);
        EXPECT_NEAR(static_cast<double>(end.u), static_cast<double>(b.length), 3.0);
        EXPECT_NEAR(static_cast<double>(start.v), v, 3.0);
        EXPECT_NEAR(static_cast<double>(end.v), v, 3.0);
    }
}

TEST(Rays, OfAnUnlimitedBoxCoverTheTerrain) {
    const TerrainGrid terrain = with_island();
    WaveTrainBox b = open_box(90.0);
    b.origin = {int64_t{1} << 34, -(int64_t{1} << 34)};
    b.trains = {train(90.0, 60.0, 0.5)};
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    ASSERT_EQ(land.rays.size(), 128U);
    size_t blocked = 0;
    for (const WaveRay& ray : land.rays) {
        EXPECT_NEAR(to_metres(ray.start.z), -6144.0 - 2048.0, 2.0);
        EXPECT_NEAR(to_metres(ray.end.z), 6144.0 + 2048.0, 2.0);
        for (const ActionPoint& p : ray.points) blocked += p.kind == ActionKind::blocked ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(blocked), 1200.0 / (16384.0 / 128.0), 1.0);
}

TEST(Rays, OfABoxFarFromLandAreBare) {
    const TerrainGrid terrain = with_island();
    WaveTrainBox b = box(0.0, 5000.0, 3000.0);
    b.origin.x += 100000 * lattice_per_metre;
    b.trains = {train(0.0, 60.0, 0.5)};
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    ASSERT_EQ(land.rays.size(), 93U);
    for (const WaveRay& ray : land.rays) EXPECT_TRUE(ray.points.empty());
    EXPECT_TRUE(land.fields.empty());
}

}  // namespace
}  // namespace trochoid
