#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "protocol/model/box_course.hpp"
#include "server/event/scene_sections.hpp"
#include "server/event/wind_limits.hpp"

namespace trochoid {

namespace {

constexpr NumberRange ramp_time{0.0, static_cast<double>(longest_ramp_us) / 1e6};
constexpr NumberRange ramp_metres{to_metres(shortest_ramp), to_metres(longest_side)};
constexpr NumberRange unit_range{0.0, 1.0};
constexpr NumberRange box_speed{0.0, static_cast<double>(fastest_storm)};
constexpr NumberRange amplitude_range{0x1p-20, 32.0};

/// 0, or seconds in [least, most]: how long a wind or a box lives.
int64_t read_life(SceneReader& in) {
    const double most = static_cast<double>(longest_life_us) / 1e6;
    const double seconds = in.number("life_s", {0.0, most}, "s", 0.0);
    const int64_t us = seconds_to_us(seconds);
    if (us != 0 && us < shortest_life_us)
        in.refuse("life_s", "is too short: give 0 (until stopped) or at least 1 s");
    return us;
}

/// A heading as float: a double just below 360 may round up to 360.
float read_heading(SceneReader& in) {
    const auto degrees = static_cast<float>(in.number("towards", heading_range, "degrees"));
    return degrees >= 360.0F ? 0.0F : degrees;
}

double read_reference_depth(SceneReader& in) {
    const double depth = in.number("reference_depth_m", {0.0, static_cast<double>(deepest_reference)},
                                   "m (0: deep water)", 0.0);
    if (depth != 0.0 && depth < static_cast<double>(shallowest_reference))
        in.refuse("reference_depth_m", fmt::format("is {:.10g}: give 0 (deep water) or at least {:.10g} m",
                                                   depth, shallowest_reference));
    return depth;
}

/// `velocity` as the first leg, from `begin` on, then the [[….leg]] tables.
std::vector<SceneLeg> read_legs(SceneReader& in, SeaTime begin, bool with_velocity, NumberRange speeds) {
    std::vector<SceneLeg> legs;
    if (with_velocity) {
        if (const auto* table = in.table("velocity")) {
            SceneReader velocity(in.file(), "velocity of " + in.path(), *table);
            const double towards = velocity.number("towards", heading_range, "degrees");
            legs.push_back({begin, towards, velocity.number("speed", speeds, "m/s")});
            velocity.finish();
        }
    }
    const auto tables = in.tables("leg");
    const size_t room = most_course_legs - 1;
    if (tables.size() > room)
        in.refuse("leg", fmt::format("is there {} times: write at most {} leg tables", tables.size(), room));
    for (size_t i = 0; i < tables.size(); ++i) {
        SceneReader leg(in.file(), fmt::format("leg {} of {}", i + 1, in.path()), *tables[i]);
        const SeaTime at{seconds_to_us(leg.number("at_s", scene_time, "s"))};
        if (at <= (legs.empty() ? begin : legs.back().at))
            leg.refuse("at_s",
                       "is not after the leg before it, nor after begin_s: give the legs in order of time");
        const double towards = leg.number("towards", heading_range, "degrees");
        legs.push_back({at, towards, leg.number("speed", speeds, "m/s")});
        leg.finish();
    }
    return legs;
}

/// Exponent of the power of two nearest to value (by ratio).
int nearest_power(double value) {
    int exponent = 0;
    const double mantissa = std::frexp(value, &exponent);  // [1/2, 1)
    return mantissa < 0.70710678118654757 ? exponent - 1 : exponent;
}

/// The keys of noise; amplitude and what stands for "not given" come from the caller.
SurfaceNoise read_noise(SceneReader in) {
    constexpr NumberRange steps{0.0625, 1024.0};
    constexpr NumberRange periods{0.016384, 1099511.627776};
    SurfaceNoise noise;
    noise.amplitude = static_cast<float>(in.number("amplitude_m", amplitude_range, "m"));
    const double step = in.number("step_m", steps, "m", 0.5);
    noise.step_log2 = static_cast<uint8_t>(nearest_power(step * static_cast<double>(lattice_per_metre)));
    if (std::ldexp(1.0, noise.step_log2) != step * static_cast<double>(lattice_per_metre))
        in.refuse("step_m", fmt::format("is {:.10g}: give a power of two, 0.0625 to 1024 m", step));
    const double period = in.number("period_s", periods, "s", 0.5);
    noise.period_log2 = static_cast<uint8_t>(nearest_power(period * 1e6));
    noise.persistence =
        static_cast<uint16_t>(std::min(in.number("persistence", unit_range, "", 0.5) * 65536.0, 65535.0));
    const int64_t most = std::min<int64_t>({12, noise.step_log2 - 4 + 1, noise.period_log2 - 12 + 1});
    const int64_t octaves = in.integer("octaves", 1, 12, std::min<int64_t>(3, most));
    if (octaves > most)
        in.refuse("octaves",
                  fmt::format("is {}: each octave halves step_m (not below 1/64 m) and period_s (not below "
                              "4 ms): give 1 to {}, or larger steps",
                              octaves, most));
    noise.octaves = static_cast<uint8_t>(octaves);
    noise.displayed_only = in.boolean("displayed_only", true);
    noise.seed = static_cast<uint32_t>(in.integer("seed", 1, UINT32_MAX, 1));
    in.finish();
    return noise;
}

SceneIrregular read_irregular(SceneReader in) {
    constexpr NumberRange lengths{shortest_group, longest_group};
    SceneIrregular irregular;
    irregular.form = static_cast<SceneIrregular::Form>(in.choice("preset", {"groups", "paper"}, 0));
    irregular.share = in.number("share", unit_range, "");
    irregular.seed = static_cast<uint64_t>(in.integer("seed", 1, INT64_MAX, 1));
    irregular.along_m = in.number("along_m", lengths, "m", 0.0);
    irregular.across_m = in.number("across_m", lengths, "m", 0.0);
    if (irregular.form == SceneIrregular::Form::paper && in.has("along_m"))
        in.refuse("along_m", "is 2 pi m in the paper's form: leave it out, or leave preset out");
    in.finish();
    return irregular;
}

SceneTrain read_train(SceneReader in) {
    SceneTrain train;
    train.wavelength_m = in.number("wavelength_m", {shortest_wavelength, longest_wavelength}, "m");
    train.towards_degrees = in.number("towards", heading_range, "degrees");
    train.amplitude_m = in.number("amplitude_m", amplitude_range, "m");
    train.phase_turns = in.number("phase_turns", {0.0, 0.9999999}, "turns", 0.0);
    train.choppiness = in.number("choppiness", {0.0, 4.0}, "", 1.0);
    in.finish();
    return train;
}

void read_box_ramps(SceneReader& in, SceneBox& box) {
    box.ramp_rear = to_lattice(in.number("ramp_rear_m", ramp_metres, "m", 50.0));
    box.ramp_front = to_lattice(in.number("ramp_front_m", ramp_metres, "m", 50.0));
    box.ramp_side = to_lattice(in.number("ramp_side_m", ramp_metres, "m", 50.0));
    if (box.length != 0 && box.ramp_rear + box.ramp_front > box.length)
        in.refuse("length_m",
                  "is shorter than the ramps at rear and front: lengthen it, or give shorter ramps");
    if (box.width != 0 && 2 * box.ramp_side > box.width)
        in.refuse("width_m", "is narrower than the two ramps at its sides: widen it, or give shorter ramps");
}

/// What a box's waves are made of.
void read_box_waves(SceneReader& in, SceneBox& box) {
    box.reference_depth_m = read_reference_depth(in);
    box.roundness = in.number("roundness", unit_range, "", 0.0);
    if (box.roundness != 0.0 && box.width == 0)
        in.refuse("roundness", "needs a box of limited width: give a width_m, or leave it out");
    if (const auto* table = in.table("irregular"))
        box.irregular = read_irregular({in.file(), "irregular of " + in.path(), *table});
    if (const auto* table = in.table("noise"))
        box.noise = read_noise({in.file(), "noise of " + in.path(), *table});
    const auto trains = in.tables("train");
    const bool noise = box.noise.amplitude != 0.0F;
    if ((trains.empty() && !noise) || trains.size() > most_trains)
        in.refuse("train", fmt::format("is there {} times: write 1 to {} [[box.train]] tables{}",
                                       trains.size(), most_trains, noise ? ", or none beside noise" : ""));
    if (trains.empty() && box.irregular.share != 0.0)
        in.refuse("irregular",
                  "needs trains whose heights vary: write [[box.train]] tables, or leave it out");
    for (size_t i = 0; i < trains.size(); ++i)
        box.trains.push_back(
            read_train({in.file(), fmt::format("train {} of {}", i + 1, in.path()), *trains[i]}));
}

}  // namespace

SceneWind read_wind(SceneReader in, std::string name) {
    SceneWind entry{std::move(name), {}, {}, {}};
    StartWind& wind = entry.wind;
    const NumberRange side{to_metres(shortest_wind_side), to_metres(longest_wind_side)};
    in.text("name", longest_name);
    wind.speed = static_cast<float>(in.number("speed", {slowest_wind, fastest_wind}, "m/s"));
    wind.towards_degrees = read_heading(in);
    wind.origin = in.place("origin");
    wind.fetch = to_lattice(in.number("fetch_m", side, "m"));
    wind.width = to_lattice(in.number("width_m", side, "m"));
    wind.life_us = read_life(in);
    wind.trains = static_cast<uint16_t>(in.integer("trains", 1, most_trains, 16));
    wind.directions = static_cast<uint16_t>(in.integer("directions", 0, most_trains, 0));
    if (wind.directions != 0 && wind.trains % wind.directions != 0)
        in.refuse("directions", fmt::format("is {}: give a divisor of trains ({}), or 0 (each train its own)",
                                            wind.directions, wind.trains));
    wind.spectrum = static_cast<Spectrum>(
        in.choice("spectrum", {"automatic", "pierson_moskowitz", "jonswap", "neumann"}, 0));
    wind.spreading =
        static_cast<Spreading>(in.choice("spreading", {"automatic", "cosine_squared", "hasselmann"}, 0));
    wind.reference_depth = static_cast<float>(read_reference_depth(in));
    wind.roundness = static_cast<float>(in.number("roundness", unit_range, "", 0.0));
    wind.irregularity = static_cast<float>(in.number("irregularity", unit_range, "", 0.0));
    wind.noise = static_cast<float>(in.number("noise_m", {0.0, static_cast<double>(most_noise)}, "m", 0.0));
    if (wind.noise != 0.0F && wind.noise < least_noise)
        in.refuse("noise_m", "is too small: give 0 (none) or at least 1e-6 m");
    wind.seed = static_cast<uint64_t>(in.integer("seed", 1, INT64_MAX, 1));
    entry.begin = {seconds_to_us(in.number("begin_s", scene_time, "s", 0.0))};
    entry.legs = read_legs(in, entry.begin, true, box_speed);
    in.finish();
    return entry;
}

SceneBox read_box(SceneReader in, std::string name) {
    SceneBox box;
    box.name = std::move(name);
    const NumberRange side{0.0, to_metres(longest_side)};
    in.text("name", longest_name);
    box.towards_degrees = in.number("towards", heading_range, "degrees");
    box.origin = in.place("origin");
    box.length = to_lattice(in.number("length_m", side, "m (0: unlimited)"));
    box.width = to_lattice(in.number("width_m", side, "m (0: unlimited)"));
    read_box_ramps(in, box);
    box.begin = {seconds_to_us(in.number("begin_s", scene_time, "s", 0.0))};
    box.build_up_us = seconds_to_us(in.number("build_up_s", ramp_time, "s", 10.0));
    box.life_us = read_life(in);
    box.decay_us = seconds_to_us(in.number("decay_s", ramp_time, "s", 10.0));
    box.front_speed = in.number("front_speed", {0.0, 100.0}, "m/s (0: the whole box at once)", 0.0);
    if (box.front_speed != 0.0 && box.length == 0)
        in.refuse("front_speed", "needs a box of limited length: give a length_m, or leave it out");
    read_box_waves(in, box);
    box.legs = read_legs(in, box.begin, true, box_speed);
    if (!box.legs.empty() && box.length == 0 && box.width == 0)
        in.refuse(
            in.has("velocity") ? "velocity" : "leg",
            "needs a box with a limited side, as an unlimited one has nothing that moves: give length_m or "
            "width_m, or leave it out");
    in.finish();
    return box;
}

SceneBox read_ripples(SceneReader in) {
    SceneBox box;
    box.name = ripples_name;
    box.ramp_rear = box.ramp_front = box.ramp_side = shortest_ramp;
    box.begin = {seconds_to_us(scene_time.least)};
    box.noise = read_noise(std::move(in));
    return box;
}

SceneShip read_ship(SceneReader in, std::string name) {
    SceneShip entry;
    StartShip& ship = entry.ship;
    constexpr NumberRange speeds{static_cast<double>(slowest_ship), static_cast<double>(fastest_ship)};
    in.text("name", longest_name);
    ship.name = std::move(name);
    ship.at = in.place("at");
    ship.towards_degrees = read_heading(in);
    ship.speed = static_cast<float>(in.number("speed", speeds, "m/s"));
    ship.length = static_cast<float>(in.number(
        "length_m", {static_cast<double>(shortest_ship), static_cast<double>(longest_ship)}, "m", 100.0));
    ship.beam = static_cast<float>(
        in.number("beam_m", {0.0, static_cast<double>(ship.length)}, "m (0: a seventh of the length)", 0.0));
    entry.begin = {seconds_to_us(in.number("begin_s", scene_time, "s", 0.0))};
    entry.legs = read_legs(in, entry.begin, false, {0.0, speeds.most});
    for (size_t i = 0; i < entry.legs.size(); ++i) {
        const double speed = entry.legs[i].speed;
        const bool last = i + 1 == entry.legs.size();
        if (speed < speeds.least && !(speed == 0.0 && last))
            in.refuse(
                "leg",
                fmt::format("number {} has the speed {:.10g}: give {:.10g} to {:.10g} m/s, or 0 in the last "
                            "one to stop the ship",
                            i + 1, speed, speeds.least, speeds.most));
    }
    in.finish();
    return entry;
}

ChangeLand read_breakwater(SceneReader in) {
    constexpr double crest = static_cast<double>(highest_crest);
    ChangeLand change;
    change.line = in.places("line", fewest_line_points, most_line_points);
    change.width = static_cast<float>(in.number(
        "width_m", {static_cast<double>(narrowest_crest), static_cast<double>(widest_crest)}, "m", 20.0));
    change.crest = static_cast<float>(in.number("crest_m", {-crest, crest}, "m", 3.0));
    change.dig = in.boolean("dig", false);
    in.finish();
    return change;
}

}  // namespace trochoid
