// The boxes that a scene writes by hand.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/event/wind_limits.hpp"
#include "server/world/box_effects.hpp"
#include "server/world/box_placement.hpp"
#include "server/world/box_steering.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/wind_box.hpp"

namespace trochoid {

namespace {

double depth_of(const SceneBox& scene) {
    return scene.reference_depth_m == 0.0 ? deep_water : scene.reference_depth_m;
}

std::vector<WaveTrain> trains_of(const SceneBox& scene) {
    std::vector<WaveTrain> trains;
    for (const SceneTrain& train : scene.trains) {
        const QuantisedVector k =
            quantise(2.0 * pi / train.wavelength_m, heading_vector(train.towards_degrees));
        const auto phase = static_cast<uint32_t>(static_cast<int64_t>(train.phase_turns * 0x1p32 + 0.5));
        trains.push_back({k.kx,
                          k.kz,
                          quantised_omega(k, depth_of(scene)),
                          phase,
                          static_cast<float>(train.amplitude_m),
                          static_cast<float>(train.choppiness),
                          {}});
    }
    std::stable_sort(trains.begin(), trains.end(), [](const WaveTrain& a, const WaveTrain& b) {
        return wave_number_of({a.kx, a.kz}) < wave_number_of({b.kx, b.kz});
    });
    return trains;
}

/// As the scene gives them; what it leaves out comes from the highest train.
IrregularHeight irregular_of(const SceneBox& scene, const WaveTrainBox& box) {
    const SceneIrregular& asked = scene.irregular;
    if (asked.share == 0.0 || box.trains.empty()) return {};
    const HeadingVector u = heading_vector(scene.towards_degrees);
    const WaveTrain& highest =
        *std::max_element(box.trains.begin(), box.trains.end(),
                          [](const WaveTrain& a, const WaveTrain& b) { return a.amplitude < b.amplitude; });
    const double k = wave_number_of({highest.kx, highest.kz});
    const bool literal = asked.form == SceneIrregular::Form::paper;
    const double standard = literal ? 2.0 * pi : group_wavelengths * 2.0 * pi / k;
    const double along = asked.along_m == 0.0 ? standard : asked.along_m;
    const double across = asked.across_m == 0.0 ? along : asked.across_m;
    if (literal) return literal_heights(asked.share, u, along, across, box.origin);
    return grouped_heights(asked.share, u, along, across, group_speed_at(k, depth_of(scene)), asked.seed);
}

}  // namespace

Result<WaveTrainBox> box_of(const SceneBox& scene, NewIds ids) {
    WaveTrainBox box;
    box.id = ids.box;
    box.first_train = ids.first_train;
    box.length = scene.length;
    box.width = scene.width;
    place(box, scene.towards_degrees, scene.origin);
    if (!corners_inside_world(box))
        return Error{ErrorCode::value_out_of_range, "the box leaves the world: move it or make it smaller"};
    box.ramp_rear = static_cast<int32_t>(scene.ramp_rear);
    box.ramp_front = static_cast<int32_t>(scene.ramp_front);
    box.ramp_side = static_cast<int32_t>(scene.ramp_side);
    box.begin = scene.begin;
    box.build_up_us = scene.build_up_us;
    box.end = scene.life_us == 0 ? end_of_time : scene.begin + scene.life_us;
    box.decay_us = scene.decay_us;
    box.front_speed = front_speed_of(scene.front_speed);
    box.trains = trains_of(scene);
    box.roundness = roundness_units(scene.roundness);
    box.irregular = irregular_of(scene, box);
    box.noise = scene.noise;
    auto course = course_of(box, scene.legs, box.end + box.decay_us);
    if (!course) return course.error();
    box.course = std::move(course).value();
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
