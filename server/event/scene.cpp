#include "server/event/scene.hpp"

#include <fmt/format.h>

#include <bit>
#include <fstream>
#include <iterator>
#include <set>
#include <system_error>

#include "protocol/units/operator_error.hpp"
#include "server/event/scene_reader.hpp"
#include "server/event/wind_limits.hpp"

namespace trochoid {

namespace {

constexpr std::uintmax_t largest_scene_file = 1U << 20;
constexpr size_t longest_name = 64;
constexpr NumberRange heading{0.0, 359.999999};
/// Sea times in a scene, seconds: 1000 years either way.
constexpr NumberRange scene_time{-3.2e10, 3.2e10};
constexpr NumberRange ramp_time{0.0, static_cast<double>(longest_ramp_us) / 1e6};
constexpr NumberRange ramp_metres{to_metres(shortest_ramp), to_metres(longest_side)};

std::string read_text(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::error_code failure;
    const std::uintmax_t size = std::filesystem::file_size(file, failure);
    if (!in || failure)
        throw OperatorError(fmt::format("cannot read the scene {}: check the path", file.string()));
    if (size > largest_scene_file)
        throw OperatorError(fmt::format("{}: a scene file has at most {} bytes, this one {}: check the path",
                                        file.string(), largest_scene_file, size));
    return {std::istreambuf_iterator<char>(in), {}};
}

toml::table parse(const std::filesystem::path& file) {
    try {
        return toml::parse(read_text(file), file.string());
    } catch (const toml::parse_error& error) {
        throw OperatorError(fmt::format("{}:{}: not TOML: {}: correct this line", file.string(),
                                        error.source().begin.line, error.description()));
    }
}

/// 0, or seconds in [least, most]: how long a wind or a box lives.
int64_t read_life(SceneReader& in) {
    const double most = static_cast<double>(longest_life_us) / 1e6;
    const double seconds = in.number("life_s", {0.0, most}, "s", 0.0);
    const int64_t us = seconds_to_us(seconds);
    if (us != 0 && us < shortest_life_us)
        in.refuse("life_s", "is too short: give 0 (until stopped) or at least 1 s");
    return us;
}

void read_clock(SceneReader in, Scene& scene) {
    scene.clock_start = {seconds_to_us(in.number("start_s", scene_time, "s", 0.0))};
    scene.rate_q16 = static_cast<uint32_t>(in.number("rate", {0.0, 16.0}, "", 1.0) * 65536.0 + 0.5);
    in.finish();
}

SceneLand read_land(SceneReader in) {
    SceneLand land;
    const int64_t step = in.integer("node_step_m", 4, 256, 32);
    if ((step & (step - 1)) != 0)
        in.refuse("node_step_m", fmt::format("is {}: give a power of two, 4 to 256 m", step));
    land.node_step_log2 = static_cast<uint8_t>(10 + std::countr_zero(static_cast<uint64_t>(step)));
    land.refraction = static_cast<SceneLand::Refraction>(in.choice(
        "refraction", {"none", "phase_shift", "straight", "eikonal"}, static_cast<size_t>(land.refraction)));
    land.shoaling = static_cast<SceneLand::Shoaling>(
        in.choice("shoaling", {"paper", "linear"}, static_cast<size_t>(land.shoaling)));
    land.depth_min_m = in.number("depth_min_m", {0.1, 100.0}, "m", land.depth_min_m);
    land.breaking_ratio = in.number("breaking_ratio", {0.0, 2.0}, "", land.breaking_ratio);
    if (land.breaking_ratio != 0.0 && land.breaking_ratio < 0.1)
        in.refuse("breaking_ratio", "is too small: give 0 (no limit) or 0.1 to 2");
    land.recovery_m = in.number("recovery_m", {1.0, 100000.0}, "m", land.recovery_m);
    land.spread = in.number("spread", {0.0, 0.5}, "", land.spread);
    in.finish();
    return land;
}

SceneWind read_wind(SceneReader in, std::string name) {
    SceneWind entry{std::move(name), {}, {}};
    StartWind& wind = entry.wind;
    const NumberRange side{to_metres(shortest_wind_side), to_metres(longest_wind_side)};
    in.text("name", longest_name);
    wind.speed = static_cast<float>(in.number("speed", {slowest_wind, fastest_wind}, "m/s"));
    wind.towards_degrees = static_cast<float>(in.number("towards", heading, "degrees"));
    // A double just below 360 may round up to 360.
    if (wind.towards_degrees >= 360.0F) wind.towards_degrees = 0.0F;
    wind.origin = in.place("origin");
    wind.fetch = to_lattice(in.number("fetch_m", side, "m"));
    wind.width = to_lattice(in.number("width_m", side, "m"));
    wind.life_us = read_life(in);
    wind.trains = static_cast<uint16_t>(in.integer("trains", 1, most_trains, 16));
    wind.seed = static_cast<uint64_t>(in.integer("seed", 1, INT64_MAX, 1));
    entry.begin = {seconds_to_us(in.number("begin_s", scene_time, "s", 0.0))};
    in.finish();
    return entry;
}

SceneTrain read_train(SceneReader in) {
    SceneTrain train;
    train.wavelength_m = in.number("wavelength_m", {shortest_wavelength, longest_wavelength}, "m");
    train.towards_degrees = in.number("towards", heading, "degrees");
    train.amplitude_m = in.number("amplitude_m", {0x1p-20, 32.0}, "m");
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

SceneBox read_box(SceneReader in, std::string name) {
    SceneBox box;
    box.name = std::move(name);
    const NumberRange side{0.0, to_metres(longest_side)};
    in.text("name", longest_name);
    box.towards_degrees = in.number("towards", heading, "degrees");
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
    const auto trains = in.tables("train");
    if (trains.empty() || trains.size() > most_trains)
        in.refuse("train", fmt::format("is there {} times: write 1 to {} [[box.train]] tables", trains.size(),
                                       most_trains));
    for (size_t i = 0; i < trains.size(); ++i)
        box.trains.push_back(
            read_train({in.file(), fmt::format("train {} of box '{}'", i + 1, box.name), *trains[i]}));
    in.finish();
    return box;
}

/// The table's own name, which must be there and unlike all before it.
std::string take_name(const std::string& file, const std::string& kind, const toml::table& table,
                      std::set<std::string>& taken) {
    SceneReader in(file, kind, table);
    std::string name = in.text("name", longest_name);
    if (!taken.insert(name).second)
        in.refuse("name", fmt::format("\"{}\" is taken: give each wind and box its own", name));
    return name;
}

}  // namespace

Scene load_scene(const std::filesystem::path& file) {
    const toml::table root = parse(file);
    const std::string shown = file.string();
    SceneReader in(shown, "", root);
    Scene scene;
    scene.name = in.text("name", longest_name);
    if (in.has("terrain")) {
        scene.terrain = file.parent_path() / in.text("terrain", 4096);
        std::error_code failure;
        if (!std::filesystem::is_regular_file(scene.terrain, failure))
            in.refuse(
                "terrain",
                fmt::format("names {}, which is no file: make it with trochoid-import, or correct the path "
                            "(relative to the scene file)",
                            scene.terrain.string()));
    }
    if (const auto* table = in.table("clock")) read_clock({shown, "[clock]", *table}, scene);
    if (const auto* table = in.table("land")) scene.land = read_land({shown, "[land]", *table});
    std::set<std::string> taken;
    for (const auto* table : in.tables("wind")) {
        std::string name = take_name(shown, "a wind", *table, taken);
        SceneReader wind(shown, fmt::format("wind '{}'", name), *table);
        scene.winds.push_back(read_wind(std::move(wind), std::move(name)));
    }
    for (const auto* table : in.tables("box")) {
        std::string name = take_name(shown, "a box", *table, taken);
        SceneReader box(shown, fmt::format("box '{}'", name), *table);
        scene.boxes.push_back(read_box(std::move(box), std::move(name)));
    }
    if (scene.winds.size() + scene.boxes.size() > most_boxes)
        throw OperatorError(fmt::format("{}: {} winds and boxes are too many: keep at most {}", shown,
                                        scene.winds.size() + scene.boxes.size(), most_boxes));
    in.finish();
    return scene;
}

}  // namespace trochoid
