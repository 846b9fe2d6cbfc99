#include "server/world/ship_box.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "protocol/model/sea.hpp"
#include "server/world/dispersion.hpp"

namespace trochoid {
namespace {

constexpr int64_t second = microseconds_per_second;

StartShip ferry() {
    StartShip ship;
    ship.at = {to_lattice(500.0), to_lattice(-300.0)};
    ship.towards_degrees = 60.0F;
    ship.speed = 10.0F;
    ship.length = 120.0F;
    ship.beam = 20.0F;
    return ship;
}

double distance(LatticePoint a, LatticePoint b) {
    return std::hypot(to_metres(b.x - a.x), to_metres(b.z - a.z));
}

TEST(ShipBox, TheLawGivesTheFiguresOfItsDocument) {
    EXPECT_NEAR(ship_waves(10.0, 100.0, 14.0).transverse, 0.36, 0.005);
    EXPECT_NEAR(ship_waves(10.0, 100.0, 0.0).transverse, 0.36, 0.01) << "a seventh of the length";
    EXPECT_NEAR(ship_waves(12.0, 300.0, 43.0).transverse, 0.53, 0.005);
    EXPECT_NEAR(ship_waves(12.0, 8.0, 2.5).diverging, 0.156, 0.001);
    EXPECT_NEAR(ship_waves(12.0, 8.0, 2.5).transverse, 0.003, 0.0005);
}

TEST(ShipBox, TheLawIsContinuousAndNeverSteep) {
    for (double length = 1.0; length <= 500.0; length *= 1.7)
        for (const double beam : {0.1, length / 7.0, length}) {
            ShipWaves before = ship_waves(0.5, length, beam);
            for (double speed = 0.5; speed <= 30.0; speed += 0.01) {
                const ShipWaves now = ship_waves(speed, length, beam);
                EXPECT_GE(now.diverging, before.diverging) << "a faster ship makes no lower diverging waves";
                EXPECT_LE(std::abs(now.transverse - before.transverse), 0.06 * before.transverse + 1e-9);
                EXPECT_LE(now.diverging * gravity / (speed * speed), 0.1 + 1e-12);
                EXPECT_LE(now.transverse, now.diverging);
                before = now;
            }
        }
}

TEST(ShipBox, TheShipIsAtTheFrontEdgesMiddleAllTheWay) {
    const StartShip ship = ferry();
    const auto made = box_of(ship, {5 * second}, {{3}, {7}});
    ASSERT_TRUE(made);
    const WaveTrainBox& box = *made;
    ASSERT_TRUE(validate(box)) << validate(box).error().message;
    EXPECT_LE(distance(ship_place(box, {5 * second}), ship.at), 0.01);
    for (const int64_t after : {60, 3600, 86400}) {
        const LatticePoint place = ship_place(box, {(5 + after) * second});
        EXPECT_NEAR(distance(ship.at, place), 10.0 * static_cast<double>(after),
                    0.01 + 1e-4 * static_cast<double>(after));
        EXPECT_NEAR(std::atan2(to_metres(place.x - ship.at.x), -to_metres(place.z - ship.at.z)),
                    60.0 * std::numbers::pi / 180.0, 1e-5);
        const BoxPosition at = box_position(box, instant_of(box, {(5 + after) * second}), place);
        EXPECT_NEAR(static_cast<double>(at.u), static_cast<double>(box.length), 3.0);
        EXPECT_NEAR(static_cast<double>(at.v), static_cast<double>(box.width) / 2.0, 3.0);
    }
}

TEST(ShipBox, WavelengthAndGroupSpeedAreTheShips) {
    const WaveTrainBox box = *box_of(ferry(), {0}, {{1}, {1}});
    const double wavelength = 2.0 * std::numbers::pi * 100.0 / gravity;
    EXPECT_NEAR(0x1p40 / static_cast<double>(box.wake.inverse_length) / 1024.0, wavelength, 1e-4);
    EXPECT_NEAR(to_metres(box.length), 40.0 * wavelength, 0.01);
    EXPECT_NEAR(static_cast<double>(box.wake.group_speed) * 1e6 / (1024.0 * 0x1p24), 5.0, 1e-4);
    // The wedge of 19.47 degrees stays clear of the soft sides.
    EXPECT_GT(to_metres(box.width) / 2.0 - to_metres(box.ramp_side), to_metres(box.length) / std::sqrt(8.0));
}

TEST(ShipBox, MakesWavesBehindTheShipAndNoneBeforeOrBeside) {
    const WaveTrainBox box = *box_of(ferry(), {0}, {{1}, {1}});
    const Sea sea({prepare(box, {})});
    const SeaTime t{600 * second};
    const SeaInstant instant(sea, t);
    const LatticePoint ship = ship_place(box, t);
    const double ux = std::sin(60.0 * std::numbers::pi / 180.0),
                 uz = -std::cos(60.0 * std::numbers::pi / 180.0);
    const auto highest = [&](double tangent) {
        double most = 0.0;
        for (double behind = -500.0; behind < 1500.0; behind += 3.0) {
            const double aside = tangent * behind;
            const LatticePoint p{ship.x - to_lattice(behind * ux + aside * uz),
                                 ship.z - to_lattice(behind * uz - aside * ux)};
            const SurfaceSample sample = instant.evaluate(p);
            EXPECT_TRUE(std::isfinite(sample.ay) && std::isfinite(sample.nx));
            if (behind < 0.0) {
                EXPECT_EQ(sample.ay, 0.0F) << "ahead of the ship";
            }
            most = std::max(most, std::abs(static_cast<double>(sample.ay)));
        }
        return most;
    };
    EXPECT_GT(highest(0.0), 0.1);
    EXPECT_GT(highest(0.33), 0.1);
    EXPECT_EQ(highest(0.4), 0.0) << "beyond 21.8 degrees the sea is still";
}

TEST(ShipBox, TheSlowestAndFastestHaveSaneBoxes) {
    for (const float speed : {0.5F, 0.9F, 1.0F, 5.0F, 20.0F, 30.0F})
        for (const float length : {1.0F, 10.0F, 500.0F}) {
            StartShip ship = ferry();
            ship.speed = speed;
            ship.length = length;
            ship.beam = 0.0F;
            const auto box = box_of(ship, {0}, {{1}, {1}});
            if (!box) {
                EXPECT_NE(box.error().message.find("makes no waves"), std::string::npos);
                continue;
            }
            EXPECT_TRUE(validate(*box)) << speed << " m/s, " << length << " m";
            EXPECT_LE(to_metres(box->length), 20000.0);
        }
}

TEST(ShipBox, TheLogsWindKeepsTheHull) {
    const StartShip ship = ferry();
    StartShip back = logged_ship(logged_wind(ship));
    EXPECT_EQ(back.name, "");
    back.name = ship.name;
    EXPECT_EQ(back, ship);
    StartShip slim = ferry();
    slim.beam = 0.0F;
    EXPECT_NEAR(logged_ship(logged_wind(slim)).beam, 120.0F / 7.0F, 1e-3F);
    // However slim, she keeps her hull.
    slim.beam = 1e-6F;
    EXPECT_TRUE(has_hull(logged_hull(logged_wind(slim))));
    EXPECT_LE(logged_ship(logged_wind(slim)).beam, 0x1p-10F);
}

TEST(ShipBox, BadShipsSayWhatToDo) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto code_of = [](auto change_one) {
        StartShip ship = ferry();
        change_one(ship);
        const auto ok = validate(ship);
        return ok ? ErrorCode::none : ok.error().code;
    };
    EXPECT_EQ(code_of([](StartShip&) {}), ErrorCode::none);
    for (const float speed : {0.0F, 0.4F, -3.0F, 100.0F, nan})
        EXPECT_EQ(code_of([&](StartShip& s) { s.speed = speed; }), ErrorCode::value_out_of_range) << speed;
    for (const float course : {-1.0F, 360.0F, nan})
        EXPECT_EQ(code_of([&](StartShip& s) { s.towards_degrees = course; }), ErrorCode::value_out_of_range);
    for (const float length : {0.0F, 501.0F, nan})
        EXPECT_EQ(code_of([&](StartShip& s) { s.length = length; }), ErrorCode::value_out_of_range) << length;
    for (const float beam : {-1.0F, 121.0F, nan})
        EXPECT_EQ(code_of([&](StartShip& s) { s.beam = beam; }), ErrorCode::value_out_of_range) << beam;
    EXPECT_EQ(code_of([&](StartShip& s) { s.at.x = world_bound + 1; }), ErrorCode::value_out_of_range);
    StartShip edge = ferry();
    edge.at.x = -world_bound;
    const auto refused = box_of(edge, {0}, {{1}, {1}});
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("farther from its edge"), std::string::npos);
}

}  // namespace
}  // namespace trochoid
