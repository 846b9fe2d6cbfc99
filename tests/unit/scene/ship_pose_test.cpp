#include "client/scene/ship_pose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "client/scene/ship_hull.hpp"
#include "protocol/model/point_query.hpp"
#include "protocol/units/assert.hpp"
#include "server/world/ship_box.hpp"

namespace trochoid {
namespace {

constexpr double two_pi = 6.283185307179586;
constexpr SeaTime start{1'000'000'000};
Workers one_core{1};

SeaTime after(double seconds) { return {start.us + static_cast<int64_t>(seconds * 1e6)}; }

WaveTrainBox ship_box(uint64_t id, LatticePoint at, float towards, float speed, float length) {
    StartShip ship;
    ship.at = at;
    ship.towards_degrees = towards;
    ship.speed = speed;
    ship.length = length;
    NewIds ids;
    ids.box = {static_cast<decltype(ids.box.value)>(id)};
    ids.first_train = {static_cast<decltype(ids.first_train.value)>(100 * id)};
    auto box = box_of(ship, start, ids);
    TROCHOID_ASSERT(box.has_value(), "the test's ship");
    return std::move(box).value();
}

/// A train without borders towards the east.
WaveTrainBox wave_box(uint64_t id, double wavelength, float amplitude) {
    WaveTrainBox box;
    box.id = {static_cast<decltype(box.id.value)>(id)};
    box.first_train = {static_cast<decltype(box.first_train.value)>(100 * id)};
    box.begin = {0};
    WaveTrain train;
    train.kx = static_cast<decltype(train.kx)>(std::llround(std::ldexp(1.0 / (wavelength * 1024.0), 32)));
    train.amplitude = amplitude;
    train.phase = 0x12345678U;
    box.trains = {train};
    return box;
}

std::shared_ptr<InterestState> sea_of(std::initializer_list<WaveTrainBox> boxes) {
    auto state = std::make_shared<InterestState>();
    for (const WaveTrainBox& box : boxes) state->boxes[box.id] = std::make_shared<const WaveTrainBox>(box);
    return state;
}

SeaInstant instant_with(const WaveTrainBox& box, SeaTime t) { return SeaInstant(Sea({prepare(box, {})}), t); }

Camera camera_at(LatticePoint p) {
    Camera camera;
    camera.position = p;
    return camera;
}

/// Heading east, 100 m by 14 m.
Ship ship_at(LatticePoint place) {
    Ship ship;
    ship.place = place;
    ship.length = 100;
    ship.beam = 14;
    ship.speed = 8;
    return ship;
}

TEST(ShipPose, still_water_leaves_a_ship_level) {
    EXPECT_EQ(pose_of(ship_at({}), SeaInstant(Sea{}, start), one_core), ShipPose{});
    // Her own wake does not move her either.
    SceneInput input;
    input.state = sea_of({ship_box(3, {}, 90, 8, 100)});
    input.now = after(200);
    ShipWaters waters;
    const auto ships = waters.ships(input, camera_at({}));
    ASSERT_EQ(ships.size(), 1U);
    EXPECT_EQ(ships[0].pose, ShipPose{});
}

TEST(ShipPose, a_long_wave_carries_her_as_the_water_itself) {
    const WaveTrainBox box = wave_box(1, 2'400, 3.0F);
    double highest = 0;
    for (int i = 0; i < 24; ++i) {
        const LatticePoint place{to_lattice(100.0 * i), to_lattice(57.0 * i)};
        const SeaInstant water = instant_with(box, after(3.0 * i));
        const ShipPose pose = pose_of(ship_at(place), water, one_core);
        const WaterPoint here = water_at(water, place);
        highest = std::max(highest, pose.heave);
        EXPECT_NEAR(pose.heave, static_cast<double>(here.height), 0.02 * 3.0) << i;
        EXPECT_NEAR(pose.pitch, static_cast<double>(-here.nx / here.ny), 0.02 * 3.0 * two_pi / 2'400) << i;
        EXPECT_NEAR(pose.roll, 0.0, 1e-6) << i;
        // Beam on, the same slope makes her roll: heading north, the east is to starboard.
        Ship north = ship_at(place);
        north.heading = {0, -1};
        EXPECT_NEAR(pose_of(north, water, one_core).roll, pose.pitch, 0.03 * 3.0 * two_pi / 2'400) << i;
    }
    EXPECT_GT(highest, 2.5);
}

TEST(ShipPose, short_waves_average_out) {
    const WaveTrainBox box = wave_box(1, 20, 0.3F);
    for (int i = 0; i < 40; ++i) {
        const ShipPose pose = pose_of(ship_at({to_lattice(1.7 * i), 0}), instant_with(box, start), one_core);
        EXPECT_LT(std::abs(pose.heave), 0.15 * 0.3) << i;
        EXPECT_LT(std::abs(pose.pitch), 0.1 * 0.3 * two_pi / 20) << i;
    }
}

TEST(ShipPose, follows_from_the_sea_time_alone) {
    SceneInput input;
    input.state = sea_of(
        {wave_box(1, 150, 1.5F), ship_box(3, {}, 70, 8, 100), ship_box(4, {to_lattice(900), 0}, 200, 6, 14)});
    ShipWaters one;
    for (const double t : {10.0, 11.5, 300.0}) {
        input.now = after(t);
        one.ships(input, camera_at({}));
    }
    input.now = after(123.25);
    const auto first = one.ships(input, camera_at({}));
    ShipWaters other;
    EXPECT_EQ(other.ships(input, camera_at({})), first);
    EXPECT_EQ(first.size(), 2U);
    EXPECT_NE(first[0].pose.heave, 0.0);
}

/// Phases repeat every 2^32 lattice units along x and z, so there lies the same sea, 16 777 km away.
TEST(ShipPose, far_from_the_origin_she_lies_the_same_to_the_bit) {
    const LatticePoint here{to_lattice(12.375), to_lattice(-7.5)};
    const LatticePoint far{here.x + (int64_t{1} << 34), here.z - (int64_t{1} << 34)};
    const SeaInstant water = instant_with(wave_box(1, 170, 2.0F), start);
    const ShipPose pose = pose_of(ship_at(here), water, one_core);
    EXPECT_EQ(pose_of(ship_at(far), water, one_core), pose);
    EXPECT_NE(pose.pitch, 0.0);
}

TEST(Ships, sail_on_their_course_and_end_with_it) {
    const LatticePoint at{to_lattice(2'000), to_lattice(-700)};
    WaveTrainBox box = ship_box(3, at, 90, 8, 180);
    EXPECT_TRUE(ships_of(*sea_of({box}), {start.us - 1}).empty());
    const auto ships = ships_of(*sea_of({box}), after(100));
    ASSERT_EQ(ships.size(), 1U);
    EXPECT_EQ(ships[0].place, ship_place(box, after(100)));
    EXPECT_NEAR(to_metres(ships[0].place.x - at.x), 800.0, 0.1);
    EXPECT_NEAR(ships[0].heading.x, 1.0, 1e-9);
    EXPECT_NEAR(ships[0].speed, 8.0, 1e-3);
    box.end = after(100);
    EXPECT_TRUE(ships_of(*sea_of({box}), after(100)).empty()) << "the wake stays, the ship does not";
}

TEST(Ships, a_steered_ship_is_one_ship_and_turns) {
    WaveTrainBox before = ship_box(3, {}, 90, 8, 100);
    before.end = start;
    before.begin = {start.us - 60'000'000};
    const WaveTrainBox now = ship_box(4, ship_place(before, start), 180, 8, 100);
    const auto state = sea_of({before, now});
    for (const double t : {-0.001, 0.0, 1.0, 10.0, 100.0})
        EXPECT_EQ(ships_of(*state, after(t)).size(), 1U) << t;
    EXPECT_EQ(ships_of(*state, after(-0.001))[0].box, BoxId{3});
    const Ship first = ships_of(*state, after(0))[0];
    EXPECT_EQ(first.box, BoxId{4});
    EXPECT_NEAR(first.heading.x, 1.0, 1e-6) << "still on the old course";
    const Ship turning = ships_of(*state, after(12))[0];
    EXPECT_GT(turning.heading.x, 0.1);
    EXPECT_GT(turning.heading.y, 0.1);
    const Ship turned = ships_of(*state, after(60))[0];
    EXPECT_NEAR(turned.heading.y, 1.0, 1e-9);
    EXPECT_EQ(turned.length, turning.length);
    EXPECT_LT(std::abs(to_metres(ships_of(*state, after(0))[0].place.x -
                                 ships_of(*state, after(-0.001))[0].place.x)),
              0.1);
}

/// A ship that has stopped: the course before, and the box in which she lies.
std::shared_ptr<InterestState> stopped_ship() {
    WaveTrainBox before = ship_box(3, {to_lattice(500), 0}, 60, 8, 100);
    before.hull = {140.0F, 21.0F};
    before.end = after(100);
    NewIds ids;
    ids.box = {4};
    ids.first_train = {400};
    return sea_of({wave_box(1, 150, 1.5F), before, lying_box(before, before.end, ids)});
}

TEST(Ships, have_the_hull_that_their_boxes_tell) {
    WaveTrainBox box = ship_box(3, {}, 90, 4, 110);
    EXPECT_NE(ships_of(*sea_of({box}), after(1))[0].length, 110.0) << "the wake does not tell it";
    box.hull = {110.0F, 11.5F};
    EXPECT_EQ(ships_of(*sea_of({box}), after(1))[0].length, 110.0);
    EXPECT_EQ(ships_of(*sea_of({box}), after(1))[0].beam, 11.5);
}

TEST(Ships, lie_where_they_stopped_and_sail_on_from_there) {
    const auto state = stopped_ship();
    const Ship sailing = ships_of(*state, after(99.999))[0];
    for (const double t : {100.0, 101.0, 5000.0}) {
        const auto ships = ships_of(*state, after(t));
        ASSERT_EQ(ships.size(), 1U) << t;
        EXPECT_LT(std::abs(to_metres(ships[0].place.x - sailing.place.x)), 0.05) << t;
        EXPECT_LT(std::abs(to_metres(ships[0].place.z - sailing.place.z)), 0.05) << t;
        EXPECT_NEAR(ships[0].heading.x, sailing.heading.x, 1e-9) << t;
        EXPECT_NEAR(ships[0].heading.y, sailing.heading.y, 1e-9) << t;
        EXPECT_EQ(ships[0].speed, 0.0);
        EXPECT_EQ(ships[0].length, 140.0);
        EXPECT_EQ(ships[0].beam, 21.0);
    }
    // She floats.
    SceneInput input;
    input.state = state;
    input.now = after(200);
    ShipWaters waters;
    const auto first = waters.ships(input, camera_at({}));
    ASSERT_EQ(first.size(), 1U);
    input.now = after(203);
    EXPECT_NE(waters.ships(input, camera_at({}))[0].pose.heave, first[0].pose.heave);
    // And turns from the heading in which she lay, once she sails on.
    WaveTrainBox lying = *state->boxes.at({4});
    lying.end = after(300);
    state->boxes[{4}] = std::make_shared<const WaveTrainBox>(lying);
    WaveTrainBox next = ship_box(5, ship_place(lying, after(300)), 150, 8, 140);
    next.hull = lying.hull;
    next.course.front().from = next.begin = after(300);
    state->boxes[{5}] = std::make_shared<const WaveTrainBox>(next);
    const auto ships = ships_of(*state, after(300));
    ASSERT_EQ(ships.size(), 1U);
    EXPECT_EQ(ships[0].box, BoxId{5});
    EXPECT_NEAR(ships[0].heading.x, sailing.heading.x, 1e-6);
}

TEST(ShipPose, the_sources_own_sea_gives_the_same) {
    SceneInput input;
    input.state = sea_of(
        {wave_box(1, 150, 1.5F), ship_box(3, {}, 70, 8, 100), ship_box(4, {to_lattice(900), 0}, 200, 6, 14)});
    input.now = after(77);
    ShipWaters own;
    const auto expected = own.ships(input, camera_at({}));
    ASSERT_EQ(expected.size(), 2U);
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (const auto& [id, record] : input.state->boxes) boxes.push_back(prepare(*record, {}));
    input.sea = Sea(std::move(boxes));
    ShipWaters shared;
    EXPECT_EQ(shared.ships(input, camera_at({})), expected);
}

TEST(Ships, the_wake_tells_the_size_of_a_planing_hull_and_the_slimness_of_any) {
    const HullSize launch = hull_size(ship_box(3, {}, 0, 12, 10).wake);
    EXPECT_NEAR(launch.length, 10.0, 0.1);
    EXPECT_NEAR(launch.beam, 10.0 / 7, 0.05);
    for (const float speed : {2.0F, 5.0F, 8.0F, 11.0F, 14.0F}) {
        const HullSize hull = hull_size(ship_box(3, {}, 0, speed, 300).wake);
        EXPECT_NEAR(hull.beam * 7.0, hull.length, 0.01 * hull.length) << speed;
        EXPECT_LE(static_cast<double>(speed) / std::sqrt(9.80665 * hull.length), 0.5) << speed;
    }
    EXPECT_EQ(hull_size(ship_box(3, {}, 0, 8, 180).wake).length,
              hull_size(ship_box(3, {}, 0, 11, 180).wake).length)
        << "steering to another speed leaves the hull as it is";
}

TEST(ShipHull, stands_out_of_the_water_all_around) {
    for (const auto& hull : {freighter_hull(), launch_hull()}) {
        ASSERT_EQ(hull.size() % 3, 0U);
        EXPECT_GT(hull.size() / 3, 300U);
        EXPECT_LT(hull.size() / 3, 1'500U);
        // Of every tenth of her length something reaches below the water and well above it.
        for (float x = -0.5F; x < 0.45F; x += 0.1F) {
            float lowest = 1, highest = -1;
            for (const HullVertex& v : hull)
                if (v.place.x >= x && v.place.x <= x + 0.1F) {
                    lowest = std::min(lowest, v.place.y);
                    highest = std::max(highest, v.place.y);
                }
            EXPECT_GE(highest, 0.049F) << x;
            if (x < 0.35F) {
                EXPECT_LT(lowest, -0.03F) << x;
            }
        }
        for (const HullVertex& v : hull) {
            EXPECT_LE(std::abs(v.place.x), 0.501F);
            EXPECT_LE(std::abs(v.place.z), 0.501F);
            EXPECT_NEAR(v.normal.x * v.normal.x + v.normal.y * v.normal.y + v.normal.z * v.normal.z, 1.0F,
                        1e-3F);
        }
    }
}

}  // namespace
}  // namespace trochoid
