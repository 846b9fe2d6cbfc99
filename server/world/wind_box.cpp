#include "server/world/wind_box.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/world/box_effects.hpp"
#include "server/world/box_placement.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/train_spectrum.hpp"
#include "server/world/wind_sea.hpp"

namespace trochoid {

namespace {

/// 4 dominant wavelengths, at most 15 % of the side, at least 1 m.
int32_t natural_ramp(double wavelength_m, int64_t side) {
    const int64_t ramp = std::min(to_lattice(4.0 * wavelength_m), side * 15 / 100);
    return static_cast<int32_t>(std::max<int64_t>(ramp, shortest_ramp));
}

}  // namespace

WaveTrainBox box_of(const StartWind& wind, SeaTime begin, NewIds ids) {
    const WindSea sea = wind_sea(static_cast<double>(wind.speed), wind.fetch, wind.spectrum);
    const double heading = static_cast<double>(wind.towards_degrees);
    const double depth = reference_depth_of(wind);
    const double peak_wave_number = wave_number_at(sea.peak_omega, depth);
    const double wavelength = 2.0 * pi / peak_wave_number;
    const double group_speed = group_speed_at(peak_wave_number, depth);
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
    box.roundness = roundness_units(static_cast<double>(wind.roundness));
    box.trains = wind_trains(wind);
    box.course =
        even_course(box, begin, box.end + box.decay_us, course_speed_of(static_cast<double>(wind.vx)),
                    course_speed_of(static_cast<double>(wind.vz)));
    const double group = group_wavelengths * wavelength;
    box.irregular = grouped_heights(static_cast<double>(wind.irregularity), heading_vector(heading), group,
                                    group, group_speed, wind.seed);
    box.noise = capillary_noise(wind.noise, wind.seed);
    return box;
}

}  // namespace trochoid
