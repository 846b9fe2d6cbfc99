// Whether a wind's figures lie in their ranges.
#include <fmt/format.h>

#include <string>
#include <utility>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/event/wind_limits.hpp"
#include "server/world/box_placement.hpp"
#include "server/world/wind_box.hpp"

namespace trochoid {

namespace {

Error out_of_range(std::string message) { return {ErrorCode::value_out_of_range, std::move(message)}; }

// Each comparison below is written so that NaN is refused too.

Result<Done> check_blowing(const StartWind& wind) {
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
    return Done{};
}

Result<Done> check_spectrum(const StartWind& wind) {
    if (wind.trains == 0 || wind.trains > most_trains)
        return Error{ErrorCode::too_many_trains,
                     fmt::format("the wind asks for {} wave trains: give 1 to {}", wind.trains, most_trains)};
    if (wind.directions != 0 && wind.trains % wind.directions != 0)
        return out_of_range(fmt::format(
            "the wind asks for {} wave trains in {} directions each frequency: give 0 (every train "
            "has its own) or a number that divides the trains",
            wind.trains, wind.directions));
    if (wind.spectrum > Spectrum::neumann)
        return out_of_range(fmt::format(
            "the wind's spectrum is number {}: give automatic (0), pierson_moskowitz (1), jonswap (2) "
            "or neumann (3)",
            static_cast<int>(wind.spectrum)));
    if (wind.spreading > Spreading::hasselmann)
        return out_of_range(fmt::format(
            "the wind's spreading is number {}: give automatic (0), cosine_squared (1) or hasselmann (2)",
            static_cast<int>(wind.spreading)));
    if (!(wind.reference_depth == 0.0F ||
          (wind.reference_depth >= shallowest_reference && wind.reference_depth <= deepest_reference)))
        return out_of_range(fmt::format("the wind's reference depth is {} m: give 0 (deep) or {} to {}",
                                        wind.reference_depth, shallowest_reference, deepest_reference));
    return Done{};
}

Result<Done> check_effects(const StartWind& wind) {
    for (const auto& [name, share] :
         {std::pair{"roundness", wind.roundness}, std::pair{"irregularity", wind.irregularity}})
        if (!(share >= 0.0F && share <= 1.0F))
            return out_of_range(fmt::format("the wind's {} is {}: give 0 to 1", name, share));
    if (!(wind.noise == 0.0F || (wind.noise >= least_noise && wind.noise <= most_noise)))
        return out_of_range(fmt::format("the wind's noise is {} m: give 0 (none) or {:.2g} to {}", wind.noise,
                                        least_noise, most_noise));
    // The slack is for the rounding of components that come from a heading.
    if (!(wind.vx * wind.vx + wind.vz * wind.vz <= fastest_storm * fastest_storm * 1.0001F))
        return out_of_range(
            fmt::format("the wind's box moves at {} m/s east and {} m/s south: give a speed of 0 to {}",
                        wind.vx, wind.vz, fastest_storm));
    return Done{};
}

}  // namespace

Result<Done> validate(const StartWind& wind) {
    for (const auto check : {check_blowing, check_spectrum, check_effects})
        if (auto ok = check(wind); !ok) return ok;
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

}  // namespace trochoid
