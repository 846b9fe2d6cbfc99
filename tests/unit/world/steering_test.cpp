// Storms and ships that move, through the authoritative world.
#include <gtest/gtest.h>

#include <cmath>

#include "server/event/event_log.hpp"
#include "server/world/box_steering.hpp"
#include "server/world/ship_box.hpp"
#include "server/world/steepness.hpp"
#include "server/world/world.hpp"

namespace trochoid {
namespace {

constexpr int64_t second = microseconds_per_second;

StartWind storm() {
    StartWind wind;
    wind.speed = 14.0F;
    wind.towards_degrees = 30.0F;
    wind.fetch = to_lattice(3000.0);
    wind.width = to_lattice(2000.0);
    wind.trains = 6;
    wind.seed = 3;
    wind.vx = 8.0F;
    wind.vz = -6.0F;
    return wind;
}

StartShip ferry() {
    StartShip ship;
    ship.towards_degrees = 90.0F;
    ship.speed = 8.0F;
    ship.name = "ferry";
    return ship;
}

template <class What>
void apply(World& world, SeaTime effective, What what) {
    const uint64_t id = world.state()->log_position.value + 1;
    world.apply({id, effective, std::move(what)}, Bytes{static_cast<uint8_t>(id)});
}

Result<Steering> steer(World& world, const Steer& course, SeaTime effective) {
    auto steering = world.plan(course, effective);
    if (steering)
        for (auto& what : steering->events) apply(world, steering->effective, what);
    return steering;
}

LatticePoint corner(const World& world, BoxId box, SeaTime t) {
    return instant_of(world.state()->boxes.at(box)->sea->record, t).origin;
}

double gap(LatticePoint a, LatticePoint b) { return std::hypot(to_metres(b.x - a.x), to_metres(b.z - a.z)); }

/// Heights on a grid of 3 x 3 km at one time.
std::vector<float> heights(const World& world, SeaTime t) {
    const SeaInstant instant(world.state()->sea, t);
    std::vector<float> list;
    for (int64_t x = -15; x <= 15; ++x)
        for (int64_t z = -15; z <= 15; ++z)
            list.push_back(instant.evaluate({x * 100 * 1024, z * 100 * 1024}).ay);
    return list;
}

TEST(Steering, AStormTurnsWhereItIsAndItsPastStaysAsItWas) {
    World world("test", nullptr, {});
    apply(world, {0}, *world.plan(storm(), {0}));
    const SeaTime turn{400 * second};
    const LatticePoint before = corner(world, {1}, turn);
    std::vector<std::vector<float>> past;
    for (const int64_t s : {0, 100, 399}) past.push_back(heights(world, {s * second}));
    const auto steering = steer(world, {{1}, 180.0F, 20.0F}, turn);
    ASSERT_TRUE(steering) << steering.error().message;
    EXPECT_EQ(steering->box, BoxId{1});
    EXPECT_EQ(steering->effective, turn);
    EXPECT_EQ(corner(world, {1}, turn), before);
    EXPECT_LE(gap(corner(world, {1}, turn - 1), before), 0.01);
    const LatticePoint later = corner(world, {1}, turn + 60 * second);
    EXPECT_NEAR(to_metres(later.z - before.z), 1200.0, 0.1);
    EXPECT_NEAR(to_metres(later.x - before.x), 0.0, 0.1);
    size_t i = 0;
    for (const int64_t s : {0, 100, 399}) EXPECT_EQ(heights(world, {s * second}), past[i++]) << s;
}

TEST(Steering, SpeedZeroLetsAStormLieStill) {
    World world("test", nullptr, {});
    apply(world, {0}, *world.plan(storm(), {0}));
    ASSERT_TRUE(steer(world, {{1}, 0.0F, 0.0F}, {100 * second}));
    EXPECT_EQ(corner(world, {1}, {100 * second}), corner(world, {1}, {9000 * second}));
    ASSERT_TRUE(steer(world, {{1}, 90.0F, 5.0F}, {200 * second})) << "and goes on when it is told to";
    EXPECT_NEAR(gap(corner(world, {1}, {200 * second}), corner(world, {1}, {300 * second})), 500.0, 0.1);
}

TEST(Steering, AnEarlierCourseTakesThePlaceOfLaterOnes) {
    World world("test", nullptr, {});
    apply(world, {0}, *world.plan(storm(), {0}));
    ASSERT_TRUE(steer(world, {{1}, 0.0F, 10.0F}, {500 * second}));
    ASSERT_TRUE(steer(world, {{1}, 180.0F, 10.0F}, {300 * second}));
    ASSERT_TRUE(steer(world, {{1}, 90.0F, 10.0F}, {300 * second}));
    const auto& course = world.state()->boxes.at({1})->sea->record.course;
    ASSERT_EQ(course.size(), 2U);
    EXPECT_EQ(course.back().from, SeaTime{300 * second});
    // Before it blows a storm may be told where to go at its beginning.
    StartWind later = storm();
    apply(world, {1000 * second}, *world.plan(later, {1000 * second}));
    const auto early = steer(world, {{2}, 180.0F, 10.0F}, {600 * second});
    ASSERT_TRUE(early);
    EXPECT_EQ(early->effective, SeaTime{1000 * second});
    EXPECT_EQ(world.state()->boxes.at({2})->sea->record.course.size(), 1U);
}

TEST(Steering, ACourseThatIsFullRefusesClearly) {
    World world("test", nullptr, {});
    apply(world, {0}, *world.plan(storm(), {0}));
    Result<Steering> last = Error{};
    int taken = 0;
    for (int i = 1; i < 100; ++i) {
        last = steer(world, {{1}, static_cast<float>(i), 10.0F}, {i * second});
        if (!last) break;
        ++taken;
    }
    EXPECT_EQ(taken, 63) << "64 legs with the first";
    ASSERT_FALSE(last);
    EXPECT_EQ(last.error().code, ErrorCode::too_many_legs);
    EXPECT_NE(last.error().message.find("start another one"), std::string::npos);
    EXPECT_TRUE(validate(world.state()->boxes.at({1})->sea->record));
}

TEST(Steering, WhatCannotBeSteeredSaysWhy) {
    World world("test", nullptr, {});
    StartWind still = storm();
    still.vx = still.vz = 0.0F;
    still.life_us = 500 * second;
    apply(world, {0}, *world.plan(still, {0}));
    StartWind brief = storm();
    brief.life_us = 100 * second;
    apply(world, {0}, *world.plan(brief, {0}));
    EXPECT_EQ(world.plan(Steer{{9}, 0.0F, 1.0F}, {0}).error().code, ErrorCode::unknown_box);
    EXPECT_EQ(world.plan(Steer{{1}, 0.0F, 1.0F}, {0}).error().code, ErrorCode::not_moving);
    EXPECT_EQ(world.plan(Steer{{2}, 0.0F, 1.0F}, {100 * second}).error().code, ErrorCode::already_ending);
    const float nan = std::nanf("");
    for (const Steer& bad : {Steer{{2}, -1.0F, 1.0F}, Steer{{2}, 360.0F, 1.0F}, Steer{{2}, nan, 1.0F},
                             Steer{{2}, 0.0F, -1.0F}, Steer{{2}, 0.0F, 101.0F}, Steer{{2}, 0.0F, nan}})
        EXPECT_EQ(world.plan(bad, {0}).error().code, ErrorCode::value_out_of_range);
    EXPECT_EQ(world.state()->log_position, LogPosition{2}) << "nothing came of it";
}

TEST(Steering, AStormLiesStillAtTheWorldsEdge) {
    StartWind wind = storm();
    wind.origin = {world_bound - to_lattice(50000.0), 0};
    wind.vx = 100.0F;
    wind.vz = 0.0F;
    World world("test", nullptr, {});
    apply(world, {0}, *world.plan(wind, {0}));
    const WaveTrainBox& record = world.state()->boxes.at({1})->sea->record;
    ASSERT_TRUE(validate(record)) << validate(record).error().message;
    const LatticePoint end = corner(world, {1}, {100'000 * second});
    EXPECT_EQ(end, corner(world, {1}, {900'000 * second}));
    EXPECT_GT(end.x, record.origin.x + to_lattice(30000.0));
}

TEST(Steering, AScenesTrackIsTheCourse) {
    SceneWind scene;
    scene.name = "storm";
    scene.wind = storm();
    scene.wind.vx = scene.wind.vz = 0.0F;
    scene.legs = {{{0}, 90.0, 10.0}, {{100 * second}, 180.0, 20.0}, {{200 * second}, 0.0, 0.0}};
    World world("test", nullptr, {});
    const auto planned = world.plan(scene);
    ASSERT_TRUE(planned) << planned.error().message;
    apply(world, {0}, *planned);
    const LatticePoint start = corner(world, {1}, {0});
    const LatticePoint turn = corner(world, {1}, {100 * second});
    const LatticePoint end = corner(world, {1}, {200 * second});
    EXPECT_NEAR(to_metres(turn.x - start.x), 1000.0, 0.1);
    EXPECT_NEAR(to_metres(end.z - turn.z), 2000.0, 0.1);
    EXPECT_EQ(corner(world, {1}, {99999 * second}), end);
    EXPECT_TRUE(steerable(planned->box));
}

TEST(Steering, AShipsNewCourseIsANewBoxFromWhereItIs) {
    World world("test", nullptr, {});
    apply(world, {0}, *world.plan(ferry(), {0}));
    const SeaTime turn{300 * second};
    const LatticePoint there = ship_place(world.state()->boxes.at({1})->sea->record, turn);
    EXPECT_NEAR(to_metres(there.x), 2400.0, 0.1);
    const auto before = heights(world, turn - 1);
    const auto steering = steer(world, {{1}, 0.0F, 12.0F}, turn);
    ASSERT_TRUE(steering) << steering.error().message;
    EXPECT_EQ(steering->box, BoxId{2});
    ASSERT_EQ(steering->events.size(), 2U);
    const auto state = world.state();
    const WaveTrainBox& old_leg = state->boxes.at({1})->sea->record;
    const WaveTrainBox& new_leg = state->boxes.at({2})->sea->record;
    EXPECT_EQ(old_leg.end, turn);
    EXPECT_GT(old_leg.decay_us, 0);
    EXPECT_EQ(new_leg.begin, turn);
    EXPECT_LE(gap(ship_place(new_leg, turn), there), 0.01);
    EXPECT_EQ(state->boxes.at({2})->name, "ferry");
    EXPECT_EQ(heights(world, turn - 1), before);
    const LatticePoint later = ship_place(new_leg, turn + 10 * second);
    EXPECT_NEAR(to_metres(there.z - later.z), 120.0, 0.1);
    EXPECT_EQ(world.plan(Steer{{1}, 0.0F, 5.0F}, turn + 1).error().code, ErrorCode::already_ending);
}

const WaveTrainBox& record(const World& world, BoxId box) {
    return world.state()->boxes.at(box)->sea->record;
}

TEST(Steering, AShipThatStopsLiesWhereSheIsTurnedAsSheWas) {
    World world("test", nullptr, {});
    StartShip asked = ferry();
    asked.at = {to_lattice(1234.5), to_lattice(-77.25)};
    asked.towards_degrees = 37.0F;
    asked.length = 140.0F;
    asked.beam = 21.0F;
    apply(world, {0}, *world.plan(asked, {0}));
    EXPECT_EQ(record(world, {1}).hull, (Hull{140.0F, 21.0F}));
    const SeaTime stop{300 * second};
    const LatticePoint there = ship_place(record(world, {1}), stop);
    const auto stopped = steer(world, {{1}, 250.0F, 0.0F}, stop);
    ASSERT_TRUE(stopped) << stopped.error().message;
    EXPECT_EQ(stopped->box, BoxId{2});
    EXPECT_EQ(stopped->events.size(), 2U);
    const WaveTrainBox lying = record(world, {2});
    EXPECT_EQ(record(world, {1}).end, stop);
    EXPECT_EQ(lying.begin, stop);
    EXPECT_EQ(lying.end, end_of_time);
    EXPECT_EQ(lying.hull, (Hull{140.0F, 21.0F}));
    EXPECT_EQ(lying.ux, record(world, {1}).ux);
    EXPECT_EQ(lying.uz, record(world, {1}).uz);
    for (const int64_t s : {0, 1, 100'000}) EXPECT_EQ(ship_place(lying, stop + s * second), there) << s;
    // She moves no water.
    const SeaInstant with_her(world.state()->sea, stop + 60 * second);
    const SeaInstant bare = with_her.without({2});
    for (int64_t i = -40; i <= 40; ++i) {
        const LatticePoint p{there.x + i * 3000, there.z + i * 777};
        ASSERT_EQ(with_her.evaluate(p), bare.evaluate(p));
    }
    EXPECT_EQ(height_bound(lying), 0.0);
    const auto list = summaries(*world.state(), stop + second);
    ASSERT_EQ(list.size(), 2U);
    EXPECT_EQ(list[1].kind, BoxKind::ship);
    EXPECT_EQ(list[1].name, "ferry");
    EXPECT_EQ(list[1].trains, 0);
    EXPECT_EQ(list[1].vx, 0.0F);
    EXPECT_EQ(list[1].hull, (Hull{140.0F, 21.0F}));
    EXPECT_EQ(list[1].towards_degrees, 37.0F);
    EXPECT_EQ(list[1].at, there);
    EXPECT_EQ(world.plan(Steer{{2}, 0.0F, 0.0F}, stop + second).error().code, ErrorCode::not_moving);
    // Steered again she goes on from there, the same ship.
    const SeaTime again{500 * second};
    const auto sailing = steer(world, {{2}, 0.0F, 6.0F}, again);
    ASSERT_TRUE(sailing) << sailing.error().message;
    EXPECT_EQ(record(world, {2}).end, again);
    EXPECT_EQ(record(world, sailing->box).hull, (Hull{140.0F, 21.0F}));
    EXPECT_LE(gap(ship_place(record(world, sailing->box), again), there), 0.01);
    EXPECT_EQ(world.state()->boxes.at(sailing->box)->name, "ferry");
}

TEST(Steering, ALyingShipIsTakenOutByAStopAndTracedOnNoLand) {
    World world("test", nullptr, {});
    apply(world, {0}, *world.plan(ferry(), {0}));
    ASSERT_TRUE(steer(world, {{1}, 0.0F, 0.0F}, {100 * second}));
    EXPECT_TRUE(world.on_land_at({200 * second}).empty());
    const auto out = world.plan(StopWind{{2}}, {300 * second});
    ASSERT_TRUE(out) << out.error().message;
    apply(world, out->end, *out);
    EXPECT_EQ(record(world, {2}).end, SeaTime{300 * second});
    EXPECT_EQ(record(world, {2}).decay_us, 0);
    EXPECT_EQ(world.plan(Steer{{2}, 0.0F, 5.0F}, {301 * second}).error().code, ErrorCode::already_ending);
    EXPECT_TRUE(world.plan(ferry(), {301 * second})) << "her name is free again";
}

/// Logs written before boxes had hulls have the sizes in the wind's place, and those written since hold the same bytes.
TEST(Steering, ALogWithoutHullsGivesShipsTheirs) {
    World world("test", nullptr, {});
    const auto planned = world.plan(ferry(), {0});
    ASSERT_TRUE(planned);
    EXPECT_EQ(planned->box.hull, Hull{});
    BoxStarted old = *planned;
    old.wind.fetch = to_lattice(85.0);
    old.wind.width = to_lattice(12.5);
    apply(world, {0}, old);
    EXPECT_EQ(record(world, {1}).hull, (Hull{85.0F, 12.5F}));
    World strange("test", nullptr, {});
    old.wind.fetch = 0;
    apply(strange, {0}, old);
    EXPECT_EQ(record(strange, {1}).hull, Hull{}) << "a wake of unknown make";
}

TEST(Steering, StoppingAShipLetsItsWakeDie) {
    World world("test", nullptr, {});
    apply(world, {0}, *world.plan(ferry(), {0}));
    const auto ending = world.plan(StopWind{{1}}, {200 * second});
    ASSERT_TRUE(ending);
    apply(world, ending->end, *ending);
    const WaveTrainBox& record = world.state()->boxes.at({1})->sea->record;
    const SeaInstant dead(world.state()->sea, record.end + record.decay_us);
    EXPECT_TRUE(dead.live().empty());
    const SeaInstant dying(world.state()->sea, record.end + record.decay_us / 4);
    EXPECT_FALSE(dying.live().empty());
}

TEST(Steering, ShipsThatCannotSailOnAreRefused) {
    World world("test", nullptr, {});
    apply(world, {0}, *world.plan(ferry(), {0}));
    EXPECT_EQ(world.plan(Steer{{1}, 0.0F, 31.0F}, {10}).error().code, ErrorCode::value_out_of_range);
    EXPECT_EQ(world.plan(Steer{{1}, 0.0F, 0.1F}, {10}).error().code, ErrorCode::value_out_of_range);
    const auto list = summaries(*world.state(), {100 * second});
    ASSERT_EQ(list.size(), 1U);
    EXPECT_EQ(list[0].name, "ferry");
    EXPECT_EQ(list[0].trains, 0);
    EXPECT_EQ(list[0].kind, BoxKind::ship);
    EXPECT_NEAR(list[0].vx, 8.0F, 1e-3F);
    EXPECT_NEAR(to_metres(list[0].at.x), 800.0, 0.1);
    EXPECT_GT(list[0].significant_height, 0.1F);
}

TEST(Steering, AShipsNameIsHersWhileSheSails) {
    World world("test", nullptr, {});
    const auto first = world.plan(ferry(), {0});
    ASSERT_TRUE(first);
    apply(world, {0}, *first);
    const auto again = world.plan(ferry(), {60 * second});
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().code, ErrorCode::value_out_of_range);
    EXPECT_EQ(again.error().message,
              "a ship named 'ferry' sails already, as box 1: give another name, or stop her");
    EXPECT_FALSE(world.plan(ferry(), {-60 * second})) << "both would sail later on";
    // A new course is the same ship under the same name, and holds it.
    const auto turned = steer(world, {first->box.id, 10.0F, 8.0F}, {100 * second});
    ASSERT_TRUE(turned);
    EXPECT_EQ(world.state()->boxes.at(turned->box)->name, "ferry");
    EXPECT_FALSE(world.plan(ferry(), {200 * second}));
    StartShip other = ferry();
    other.name = "pilot";
    EXPECT_TRUE(world.plan(other, {200 * second}));
    other.name.clear();
    EXPECT_TRUE(world.plan(other, {200 * second}));
    // She keeps it while she lies still; once she is taken out it is free, while her wake still decays.
    const auto lying = steer(world, {turned->box, 0.0F, 0.0F}, {300 * second});
    ASSERT_TRUE(lying);
    EXPECT_FALSE(world.plan(ferry(), {300 * second}));
    const auto out = world.plan(StopWind{lying->box}, {310 * second});
    ASSERT_TRUE(out);
    apply(world, out->end, *out);
    EXPECT_TRUE(world.plan(ferry(), {310 * second}));
}

TEST(Steering, RefusalsSpeakOfSeaTimeInSeconds) {
    World world("test", nullptr, {});
    apply(world, {0}, *world.plan(ferry(), {0}));
    const auto out = world.plan(StopWind{{1}}, {100'500'000});
    ASSERT_TRUE(out);
    apply(world, out->end, *out);
    EXPECT_EQ(
        world.plan(StopWind{{1}}, {200 * second}).error().message,
        "box 1 decays from sea time 100.500000 s (0 d 00:01:40) on: it needs no stop and takes no course");
}

}  // namespace
}  // namespace trochoid
