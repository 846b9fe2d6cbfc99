#include "server/world/ship_box.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/event/wind_limits.hpp"
#include "server/world/box_placement.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/integer_math.hpp"

namespace trochoid {

namespace {

constexpr double slimness = 7.0;
constexpr double steepest_ship_wave = 0.1;
constexpr double least_amplitude = 0x1p-20;

Error out_of_range(std::string message) { return {ErrorCode::value_out_of_range, std::move(message)}; }

float amplitude_of(double metres) { return metres < least_amplitude ? 0.0F : static_cast<float>(metres); }

double beam_of(double length, double beam) { return beam == 0.0 ? length / slimness : beam; }

ShipWake wake_of(const StartShip& ship, double wavelength) {
    const auto speed = static_cast<double>(ship.speed);
    const ShipWaves waves =
        ship_waves(speed, static_cast<double>(ship.length), static_cast<double>(ship.beam));
    ShipWake wake;
    wake.transverse = amplitude_of(waves.transverse);
    wake.diverging = amplitude_of(waves.diverging);
    wake.choppiness = 1.0F;
    const double inverse = 0x1p40 / (wavelength * static_cast<double>(lattice_per_metre));
    wake.inverse_length = static_cast<uint32_t>(std::min(inverse, 0x1p31));
    wake.group_speed = std::max(front_speed_of(speed / 2.0), uint32_t{1});
    return wake;
}

}  // namespace

ShipWaves ship_waves(double speed, double length, double beam) {
    const double froude = speed / std::sqrt(gravity * length);
    const double wide = beam_of(length, beam);
    const double planing = std::min(froude, 0.5);
    const double steepest = steepest_ship_wave * speed * speed / gravity;
    const double diverging = std::min(wide / 4.0 * planing * planing, steepest);
    const double left = std::min(1.0, 0.5 / froude);
    return {diverging * (left * left) * (left * left), diverging};
}

// Each comparison is written so that NaN is refused too.
Result<Done> validate(const StartShip& ship) {
    if (!(ship.speed >= slowest_ship && ship.speed <= fastest_ship))
        return out_of_range(
            fmt::format("the ship's speed is {} m/s: give {} to {}", ship.speed, slowest_ship, fastest_ship));
    if (!(ship.towards_degrees >= 0.0F && ship.towards_degrees < 360.0F))
        return out_of_range(
            fmt::format("the ship's course is {} degrees: give 0 to below 360, clockwise from north",
                        ship.towards_degrees));
    if (!(ship.length >= shortest_ship && ship.length <= longest_ship))
        return out_of_range(
            fmt::format("the ship is {} m long: give {} to {}", ship.length, shortest_ship, longest_ship));
    if (!(ship.beam >= 0.0F && ship.beam <= ship.length))
        return out_of_range(
            fmt::format("the ship's beam is {} m: give 0 (a seventh of the length) to the length, {} m",
                        ship.beam, ship.length));
    if (!inside_world(ship.at))
        return out_of_range(
            fmt::format("the ship begins at x {} z {} m, outside the world: keep |x| and |z| within {} m",
                        to_metres(ship.at.x), to_metres(ship.at.z), to_metres(world_bound)));
    return Done{};
}

Result<WaveTrainBox> box_of(const StartShip& ship, SeaTime begin, NewIds ids) {
    const auto speed = static_cast<double>(ship.speed);
    const auto heading = static_cast<double>(ship.towards_degrees);
    const double wavelength = std::max(2.0 * pi * speed * speed / gravity, 0.5);
    WaveTrainBox box;
    box.id = ids.box;
    box.first_train = ids.first_train;
    box.length = to_lattice(std::min(wavelengths_of_wake * wavelength, longest_wake));
    box.ramp_side = static_cast<int32_t>(std::max<int64_t>(box.length / 64, shortest_ramp));
    box.width = box.length * 3 / 4 + 2 * int64_t{box.ramp_side};
    box.ramp_rear = static_cast<int32_t>(std::max<int64_t>(box.length / 4, shortest_ramp));
    box.ramp_front = shortest_ramp;
    place(box, heading, ship.at);
    // From the middle of the front edge to that of the rear.
    box.origin.x -= (box.length * box.ux) >> 30;
    box.origin.z -= (box.length * box.uz) >> 30;
    box.wake = wake_of(ship, wavelength);
    box.begin = begin;
    const double period = 2.0 * pi * speed / gravity;
    box.build_up_us = std::max(seconds_to_us(period), microseconds_per_second);
    box.decay_us = seconds_to_us(to_metres(box.length) / (speed / 2.0));
    const HeadingVector u = heading_vector(heading);
    if (corners_inside_world(box))
        box.course = even_course(box, begin, begin + longest_leg_us, course_speed_of(speed * u.east),
                                 course_speed_of(speed * u.south));
    const int64_t sailing_us = box.course.empty() ? 0 : box.course.front().duration_us - box.decay_us;
    if (sailing_us <= 0)
        return out_of_range(
            fmt::format("the ship's wake, {} m long, leaves the world: begin farther from its edge",
                        to_metres(box.length)));
    box.course.resize(1);
    box.end = begin + sailing_us;
    if (!has_wake(box.wake))
        return out_of_range(
            fmt::format("a ship {} m long makes no waves at {} m/s: give a longer or a faster one",
                        ship.length, ship.speed));
    return box;
}

WaveTrainBox lying_box(const WaveTrainBox& ship, SeaTime begin, NewIds ids) {
    WaveTrainBox box;
    box.id = ids.box;
    box.first_train = ids.first_train;
    box.ux = ship.ux;
    box.uz = ship.uz;
    box.hull = ship.hull;
    box.length = std::max(to_lattice(static_cast<double>(ship.hull.length)), int64_t{shortest_ramp});
    box.width = std::max(to_lattice(static_cast<double>(ship.hull.beam)), int64_t{shortest_ramp});
    box.begin = begin;
    // So short (0.0625 m) that no picture asks for it.
    box.trains.push_back({int32_t{1} << 26, 0, 0, 0, 0.0F, 0.0F, {}});
    const LatticePoint at = ship_place(ship, begin);
    const LatticePoint from_corner = ship_place(box, begin);
    box.origin = {at.x - from_corner.x, at.z - from_corner.z};
    return box;
}

StartWind logged_wind(const StartShip& ship) {
    StartWind wind;
    wind.speed = ship.speed;
    wind.towards_degrees = ship.towards_degrees;
    wind.origin = ship.at;
    wind.fetch = to_lattice(static_cast<double>(ship.length));
    // At least one unit: 0 would be no hull, and a seventh of the length on her next course.
    wind.width = std::max(
        to_lattice(beam_of(static_cast<double>(ship.length), static_cast<double>(ship.beam))), int64_t{1});
    wind.trains = 0;
    wind.seed = 1;
    return wind;
}

Hull logged_hull(const StartWind& wind) {
    Hull hull;
    hull.length = static_cast<float>(to_metres(wind.fetch));
    hull.beam = std::min(static_cast<float>(to_metres(wind.width)), hull.length);
    return validate(hull).has_value() ? hull : Hull{};
}

StartShip logged_ship(const StartWind& wind) {
    StartShip ship;
    ship.at = wind.origin;
    ship.towards_degrees = wind.towards_degrees;
    ship.speed = wind.speed;
    ship.length = static_cast<float>(to_metres(wind.fetch));
    ship.beam = std::min(static_cast<float>(to_metres(wind.width)), ship.length);
    return ship;
}

}  // namespace trochoid
