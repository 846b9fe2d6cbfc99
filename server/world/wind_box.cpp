#include "server/world/wind_box.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"
#include "server/event/wind_limits.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/train_spectrum.hpp"
#include "server/world/wind_sea.hpp"

namespace trochoid {

namespace {

constexpr double unit_q30 = 0x1p30;
/// Lattice units per microsecond in Q.24 of 1 m/s.
constexpr double front_unit = 1024.0 * 0x1p24 / 1e6;

Error out_of_range(std::string message) { return {ErrorCode::value_out_of_range, std::move(message)}; }

int64_t nearest(double value) { return static_cast<int64_t>(value < 0.0 ? value - 0.5 : value + 0.5); }

/// Sets u and, from the middle of the rear edge, the corner. Sides must be set.
void place(WaveTrainBox& box, double towards_degrees, LatticePoint rear_middle) {
    const HeadingVector u = heading_vector(towards_degrees);
    box.ux = static_cast<int32_t>(nearest(u.east * unit_q30));
    box.uz = static_cast<int32_t>(nearest(u.south * unit_q30));
    // v = (-uz, ux)
    const int64_t half = box.width / 2;
    box.origin = {rear_middle.x + ((box.uz * half) >> 30), rear_middle.z - ((box.ux * half) >> 30)};
}

/// All four corners; bounds_of would clamp them.
bool corners_inside_world(const WaveTrainBox& box) {
    for (const int64_t u : {int64_t{0}, box.length})
        for (const int64_t v : {int64_t{0}, box.width}) {
            const int64_t x = box.origin.x + ((u * box.ux - v * box.uz) >> 30);
            const int64_t z = box.origin.z + ((u * box.uz + v * box.ux) >> 30);
            if (!inside_world({x, z})) return false;
        }
    return true;
}

/// 4 dominant wavelengths, at most 15 % of the side, at least 1 m.
int32_t natural_ramp(double wavelength_m, int64_t side) {
    const int64_t ramp = std::min(to_lattice(4.0 * wavelength_m), side * 15 / 100);
    return static_cast<int32_t>(std::max<int64_t>(ramp, shortest_ramp));
}

uint32_t front_speed_of(double metres_per_second) {
    return static_cast<uint32_t>(nearest(metres_per_second * front_unit));
}

}  // namespace

Result<Done> validate(const StartWind& wind) {
    // Each comparison is written so that NaN is refused too.
    if (!(wind.speed >= slowest_wind && wind.speed <= fastest_wind))
        return out_of_range(
            fmt::format("the wind's speed is {} m/s: give {} to {}", wind.speed, slowest_wind, fastest_wind));
    if (!(wind.towards_degrees >= 0.0F && wind.towards_degrees < 360.0F))
        return out_of_range(
            fmt::format("the wind blows towards {} degrees: give 0 to below 360, clockwise from north",
                        wind.towards_degrees));
    for (const auto& [name, side] : {std::pair{"fetch", wind.fetch}, std::pair{"width", wind.width}})
        if (side < shortest_wind_side || side > longest_wind_side)
            return out_of_range(fmt::format("the wind's {} is {} m: give {} to {}", name, to_metres(side),
                                            to_metres(shortest_wind_side), to_metres(longest_wind_side)));
    if (wind.life_us != 0 && (wind.life_us < shortest_life_us || wind.life_us > longest_life_us))
        return out_of_range(fmt::format("the wind's life is {} us: give 0 (until stopped) or {} to {}",
                                        wind.life_us, shortest_life_us, longest_life_us));
    if (wind.trains == 0 || wind.trains > most_trains)
        return Error{ErrorCode::too_many_trains,
                     fmt::format("the wind asks for {} wave trains: give 1 to {}", wind.trains, most_trains)};
    WaveTrainBox box;
    box.length = wind.fetch;
    box.width = wind.width;
    if (inside_world(wind.origin)) place(box, static_cast<double>(wind.towards_degrees), wind.origin);
    if (!inside_world(wind.origin) || !corners_inside_world(box))
        return out_of_range(
            fmt::format("the wind's box, from x {} z {} m, leaves the world: keep |x| and |z| within {} m",
                        to_metres(wind.origin.x), to_metres(wind.origin.z), to_metres(world_bound)));
    return Done{};
}

WaveTrainBox box_of(const StartWind& wind, SeaTime begin, NewIds ids) {
    const WindSea sea = wind_sea(static_cast<double>(wind.speed), wind.fetch);
    const double heading = static_cast<double>(wind.towards_degrees);
    const double wavelength = 2.0 * pi / deep_wave_number(sea.peak_omega);
    const double group_speed = deep_group_speed(sea.peak_omega);
    WaveTrainBox box;
    box.id = ids.box;
    box.first_train = ids.first_train;
    box.length = wind.fetch;
    box.width = wind.width;
    place(box, heading, wind.origin);
    box.ramp_rear = natural_ramp(wavelength, box.length);
    box.ramp_front = box.ramp_rear;
    box.ramp_side = natural_ramp(wavelength, box.width);
    const double crossing_s = to_metres(wind.fetch) / group_speed;
    const double hundred_periods_s = 200.0 * pi / sea.peak_omega;
    box.begin = begin;
    box.build_up_us = seconds_to_us(std::min(crossing_s, hundred_periods_s));
    box.end = wind.life_us == 0 ? end_of_time : begin + wind.life_us;
    box.decay_us = std::max(box.build_up_us, 10 * microseconds_per_second);
    box.front_speed = front_speed_of(group_speed);
    box.trains = wind_trains(sea, heading, wind.trains, wind.seed);
    return box;
}

Result<WaveTrainBox> box_of(const SceneBox& scene, NewIds ids) {
    WaveTrainBox box;
    box.id = ids.box;
    box.first_train = ids.first_train;
    box.length = scene.length;
    box.width = scene.width;
    place(box, scene.towards_degrees, scene.origin);
    if (!corners_inside_world(box))
        return out_of_range("the box leaves the world: move it or make it smaller");
    box.ramp_rear = static_cast<int32_t>(scene.ramp_rear);
    box.ramp_front = static_cast<int32_t>(scene.ramp_front);
    box.ramp_side = static_cast<int32_t>(scene.ramp_side);
    box.begin = scene.begin;
    box.build_up_us = scene.build_up_us;
    box.end = scene.life_us == 0 ? end_of_time : scene.begin + scene.life_us;
    box.decay_us = scene.decay_us;
    box.front_speed = front_speed_of(scene.front_speed);
    for (const SceneTrain& train : scene.trains) {
        const QuantisedVector k =
            quantise(2.0 * pi / train.wavelength_m, heading_vector(train.towards_degrees));
        const auto phase = static_cast<uint32_t>(nearest(train.phase_turns * 0x1p32));
        box.trains.push_back({k.kx,
                              k.kz,
                              quantised_omega(k),
                              phase,
                              static_cast<float>(train.amplitude_m),
                              static_cast<float>(train.choppiness),
                              {}});
    }
    std::stable_sort(box.trains.begin(), box.trains.end(), [](const WaveTrain& a, const WaveTrain& b) {
        return wave_number_of({a.kx, a.kz}) < wave_number_of({b.kx, b.kz});
    });
    if (auto ok = validate(box); !ok) return ok.error();
    return box;
}

StartWind equivalent_wind(const SceneBox& scene) {
    double sum = 0.0;
    for (const SceneTrain& train : scene.trains) sum += train.amplitude_m * train.amplitude_m / 2.0;
    const double speed = std::sqrt(4.0 * std::sqrt(sum) * gravity / 0.21);
    StartWind wind;
    wind.speed = static_cast<float>(std::clamp(speed, double{slowest_wind}, double{fastest_wind}));
    wind.towards_degrees = static_cast<float>(scene.towards_degrees);
    if (wind.towards_degrees >= 360.0F) wind.towards_degrees = 0.0F;
    wind.origin = scene.origin;
    wind.fetch = scene.length;
    wind.width = scene.width;
    wind.life_us = scene.life_us;
    wind.trains = static_cast<uint16_t>(scene.trains.size());
    wind.seed = 1;
    return wind;
}

}  // namespace trochoid
