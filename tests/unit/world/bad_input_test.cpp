// What no sea should be asked for: a clear refusal, or a sane sea; never a NaN.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "server/event/event_log.hpp"
#include "server/event/wind_limits.hpp"
#include "server/world/steepness.hpp"
#include "server/world/world.hpp"

namespace trochoid {
namespace {

constexpr int64_t second = microseconds_per_second;
const float nan = std::numeric_limits<float>::quiet_NaN();
const float infinity = std::numeric_limits<float>::infinity();

StartWind breeze() {
    StartWind wind;
    wind.speed = 9.0F;
    wind.towards_degrees = 120.0F;
    wind.fetch = to_lattice(5000.0);
    wind.width = to_lattice(3000.0);
    wind.seed = 5;
    return wind;
}

void start(World& world, const StartWind& wind, SeaTime begin) {
    auto planned = world.plan(wind, begin);
    ASSERT_TRUE(planned) << planned.error().message;
    const uint64_t id = world.state()->log_position.value + 1;
    world.apply({id, begin, std::move(planned).value()}, Bytes{1});
}

/// Every value that a sample has, over a square of `half` metres around the origin.
void expect_sane(const World& world, SeaTime t, double half, double highest) {
    const SeaInstant instant(world.state()->sea, t);
    for (int64_t i = -8; i <= 8; ++i)
        for (int64_t j = -8; j <= 8; ++j) {
            const SurfaceSample s = instant.evaluate({to_lattice(half * static_cast<double>(i) / 8.0),
                                                      to_lattice(half * static_cast<double>(j) / 8.0)});
            for (const float v : {s.ax, s.ay, s.az, s.nx, s.ny, s.nz, s.vx, s.vy, s.vz, s.pxx, s.pzz, s.yx})
                ASSERT_TRUE(std::isfinite(v)) << i << ", " << j;
            ASSERT_LE(std::abs(static_cast<double>(s.ay)), highest);
            ASSERT_GT(s.ny, 0.0F) << "a crest folds";
        }
}

TEST(BadInput, WavesTooShortToBeRoundAreRefused) {
    const World world("test", nullptr, {});
    StartWind air = breeze();
    air.speed = 1.0F;
    air.fetch = to_lattice(32.0);
    air.width = to_lattice(100.0);
    air.trains = 64;
    EXPECT_TRUE(world.plan(air, {0}));
    air.roundness = 0.5F;
    SceneWind scene{"air", air, {0}, {{{60 * second}, 90.0, 3.0}}};
    for (const auto& refused : {world.plan(air, {0}), world.plan(scene)}) {
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::value_out_of_range);
        EXPECT_NE(refused.error().message.find("cannot be round"), std::string::npos);
    }
}

TEST(BadInput, AFullWorldGivesUpNoBoxThatStillActs) {
    World world("test", nullptr, {});
    StartShip ship;
    ship.speed = 10.0F;
    for (uint64_t i = 1; i <= most_boxes; ++i) world.apply({i, {0}, *world.plan(ship, {0})}, Bytes{1});
    const WaveTrainBox& first = world.state()->boxes.at({1})->sea->record;
    const SeaTime over = first.end + first.decay_us;
    world.set_present({60 * second});
    const auto refused = world.plan(breeze(), over + second);
    ASSERT_FALSE(refused) << "its place would be taken now";
    EXPECT_EQ(refused.error().code, ErrorCode::too_many_boxes);
    world.set_present(over);
    EXPECT_TRUE(world.plan(breeze(), over + second));
}

TEST(BadInput, NoShipSetsOutOnLandButOneMaySailAcrossIt) {
    TerrainGrid beach;  // 10 m deep in the west, dry dunes from x = 0 on
    beach.columns = beach.rows = 65;
    beach.origin_x = beach.origin_z = -32 * 32768;
    for (int64_t i = 0; i < int64_t{65} * 65; ++i) beach.heights.push_back(i % 65 < 32 ? -320 : 96);
    beach.open_sea_depth = -20 * 1024;
    World world("test", std::make_shared<const TerrainGrid>(beach), {});
    StartShip ship;
    ship.towards_degrees = 90.0F;
    ship.speed = 10.0F;
    ship.at = {to_lattice(300.0), to_lattice(-50.0)};
    const auto refused = world.plan(ship, {0});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::value_out_of_range);
    EXPECT_NE(refused.error().message.find("on land, at x 300 z -50 m, 3.0 m above"), std::string::npos)
        << refused.error().message;
    ship.at.x = to_lattice(-300.0);
    auto started = world.plan(ship, {0});
    ASSERT_TRUE(started) << started.error().message;
    world.apply({1, {0}, std::move(started).value()}, Bytes{1});
    EXPECT_TRUE(world.plan(Steer{{1}, 0.0F, 5.0F}, {60 * second})) << "she is in the dunes by then";
    ship.at.x = to_lattice(300.0);
    EXPECT_TRUE(World("test", nullptr, {}).plan(ship, {0})) << "the open sea has no land";
}

TEST(BadInput, WindsThatCannotBeAreRefusedWithARange) {
    const World world("test", nullptr, {});
    const auto expect_refused = [&](auto change_one, ErrorCode code = ErrorCode::value_out_of_range) {
        StartWind wind = breeze();
        change_one(wind);
        const auto planned = world.plan(wind, {0});
        ASSERT_FALSE(planned);
        EXPECT_EQ(planned.error().code, code) << planned.error().message;
        EXPECT_NE(planned.error().message.find(": "), std::string::npos) << planned.error().message;
    };
    for (const float speed : {0.0F, -5.0F, 100.0F, nan, infinity, 1e-30F})
        expect_refused([&](StartWind& w) { w.speed = speed; });
    for (const float heading : {-0.1F, 360.0F, nan, infinity})
        expect_refused([&](StartWind& w) { w.towards_degrees = heading; });
    for (const int64_t side : {int64_t{0}, int64_t{-1}, to_lattice(10.0), to_lattice(1e7), INT64_MAX}) {
        expect_refused([&](StartWind& w) { w.fetch = side; });
        expect_refused([&](StartWind& w) { w.width = side; });
    }
    expect_refused([](StartWind& w) { w.trains = 0; }, ErrorCode::too_many_trains);
    expect_refused([](StartWind& w) { w.trains = 257; }, ErrorCode::too_many_trains);
    expect_refused([](StartWind& w) { w.directions = 7; });
    expect_refused([](StartWind& w) { w.spectrum = static_cast<Spectrum>(9); });
    expect_refused([](StartWind& w) { w.spreading = static_cast<Spreading>(9); });
    for (const float depth : {-1.0F, 0.5F, 20000.0F, nan})
        expect_refused([&](StartWind& w) { w.reference_depth = depth; });
    for (const float share : {-0.1F, 1.1F, nan}) {
        expect_refused([&](StartWind& w) { w.roundness = share; });
        expect_refused([&](StartWind& w) { w.irregularity = share; });
    }
    for (const float noise : {-0.1F, 1.1F, 1e-9F, nan})
        expect_refused([&](StartWind& w) { w.noise = noise; });
    for (const float v : {101.0F, -101.0F, nan, infinity}) {
        expect_refused([&](StartWind& w) { w.vx = v; });
        expect_refused([&](StartWind& w) { w.vz = v; });
    }
    expect_refused([](StartWind& w) { w.life_us = -1; });
    expect_refused([](StartWind& w) { w.origin.x = world_bound; });
}

TEST(BadInput, TheWidestWindIsASaneSea) {
    World world("test", nullptr, {});
    StartWind wind = breeze();
    wind.speed = 40.0F;
    wind.fetch = wind.width = longest_wind_side;
    wind.trains = 256;
    wind.roundness = wind.irregularity = 1.0F;
    wind.noise = 1.0F;
    wind.origin = {-to_lattice(400000.0), -to_lattice(230000.0)};
    start(world, wind, {-100 * 86400 * second});
    expect_sane(world, {7 * second}, 2000.0, 150.0);
}

TEST(BadInput, FiftyOverlappingWindsNeverFold) {
    World world("test", nullptr, {});
    for (int i = 0; i < 50; ++i) {
        StartWind wind = breeze();
        wind.speed = 5.0F + static_cast<float>(i % 20);
        wind.towards_degrees = static_cast<float>((i * 37) % 360);
        const double c = to_metres(wind.fetch) / 2.0;
        const double a = (90.0 - static_cast<double>(wind.towards_degrees)) * 0.017453292519943295;
        wind.origin = {to_lattice(-c * std::cos(a)), to_lattice(c * std::sin(a))};
        wind.seed = static_cast<uint64_t>(i) + 1;
        if (i % 5 == 1) wind.roundness = 1.0F;
        if (i % 5 == 2) wind.irregularity = 1.0F;
        if (i % 5 == 3) wind.vx = 10.0F;
        start(world, wind, {-86400 * second});
    }
    double steepness = 0.0;
    for (const auto& [id, box] : world.state()->boxes) steepness += steepness_of(box->sea->record);
    EXPECT_LE(steepness, steepness_limit + 1e-6);
    EXPECT_GT(steepness, 0.7) << "all overlap in the middle";
    for (const int64_t s : {0, 10, 1000}) expect_sane(world, {s * second}, 3000.0, 200.0);
}

TEST(BadInput, HandWrittenBoxesThatLeaveTheWorldAreRefused) {
    const World world("test", nullptr, {});
    SceneBox box;
    box.name = "edge";
    box.origin = {world_bound, 0};
    box.length = longest_side;
    box.width = longest_side;
    box.ramp_rear = box.ramp_front = box.ramp_side = to_lattice(50.0);
    box.towards_degrees = 90.0;
    box.trains = {{100.0, 90.0, 1.0, 0.0, 1.0}};
    const auto planned = world.plan(box);
    ASSERT_FALSE(planned);
    EXPECT_NE(planned.error().message.find("leaves the world"), std::string::npos);
}

TEST(BadInput, TheSteepestHandWrittenBoxIsMadeFlatter) {
    World world("test", nullptr, {});
    SceneBox box;
    box.name = "wall";
    box.ramp_rear = box.ramp_front = box.ramp_side = to_lattice(50.0);
    for (int i = 0; i < 256; ++i) box.trains.push_back({0.05 + 0.01 * i, 1.4 * i, 32.0, 0.0, 4.0});
    box.irregular.share = 1.0;
    const auto planned = world.plan(box);
    ASSERT_TRUE(planned) << planned.error().message;
    EXPECT_LE(steepness_of(planned->box), 0.48);
    world.apply({1, {0}, *planned}, Bytes{1});
    expect_sane(world, {3600 * second}, 1000.0, 32.0 * 256.0 * 2.0);
}

}  // namespace
}  // namespace trochoid
