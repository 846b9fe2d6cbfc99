#include "server/event/scene.hpp"

#include <fmt/format.h>

#include <bit>
#include <fstream>
#include <iterator>
#include <set>
#include <system_error>

#include "protocol/units/operator_error.hpp"
#include "server/event/scene_reader.hpp"
#include "server/event/scene_sections.hpp"
#include "server/event/wind_limits.hpp"

namespace trochoid {

namespace {

constexpr std::uintmax_t largest_scene_file = 1U << 20;
constexpr size_t most_breakwaters = 256;

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
        in.choice("shoaling", {"paper", "linear", "decrease", "none"}, static_cast<size_t>(land.shoaling)));
    land.depth_min_m = in.number("depth_min_m", {0.1, 100.0}, "m", land.depth_min_m);
    land.breaking_ratio = in.number("breaking_ratio", {0.0, 2.0}, "", land.breaking_ratio);
    if (land.breaking_ratio != 0.0 && land.breaking_ratio < 0.1)
        in.refuse("breaking_ratio", "is too small: give 0 (no limit) or 0.1 to 2");
    land.recovery_m = in.number("recovery_m", {1.0, 100000.0}, "m", land.recovery_m);
    land.diffraction = static_cast<SceneLand::Diffraction>(
        in.choice("diffraction", {"none", "wedge", "parabolic"}, static_cast<size_t>(land.diffraction)));
    land.spread = in.number("spread", {0.0, 0.5}, "", land.spread);
    land.run_up_m = in.number("run_up_m", {0.0, 10.0}, "m", land.run_up_m);
    land.shore_decrease = in.number("shore_decrease", {0.0, 1.0}, "", land.shore_decrease);
    land.shallow_orbits = in.boolean("shallow_orbits", land.shallow_orbits);
    in.finish();
    return land;
}

/// The table's own name, which must be there and unlike all before it.
std::string take_name(const std::string& file, const std::string& kind, const toml::table& table,
                      std::set<std::string>& taken) {
    SceneReader in(file, kind, table);
    std::string name = in.text("name", longest_name);
    if (!taken.insert(name).second)
        in.refuse("name", fmt::format("\"{}\" is taken: give each wind, box and ship its own", name));
    return name;
}

/// The file's [[breakwater]] tables; without a terrain there is nothing to change.
void read_breakwaters(SceneReader& in, Scene& scene) {
    const auto tables = in.tables("breakwater");
    if (!tables.empty() && scene.terrain.empty())
        in.refuse("breakwater", "needs a terrain to change: name one under 'terrain', or remove it");
    if (tables.size() > most_breakwaters)
        in.refuse("breakwater",
                  fmt::format("is there {} times: keep at most {}", tables.size(), most_breakwaters));
    for (size_t i = 0; i < tables.size(); ++i)
        scene.breakwaters.push_back(
            read_breakwater({in.file(), fmt::format("breakwater {}", i + 1), *tables[i]}));
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
    read_breakwaters(in, scene);
    std::set<std::string> taken{ripples_name};
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
    if (const auto* table = in.table("ripples"))
        scene.boxes.push_back(read_ripples({shown, "[ripples]", *table}));
    size_t boxes = scene.winds.size() + scene.boxes.size();
    for (const auto* table : in.tables("ship")) {
        std::string name = take_name(shown, "a ship", *table, taken);
        SceneReader ship(shown, fmt::format("ship '{}'", name), *table);
        scene.ships.push_back(read_ship(std::move(ship), std::move(name)));
        boxes += 1 + scene.ships.back().legs.size();
    }
    if (boxes > most_boxes)
        throw OperatorError(
            fmt::format("{}: {} winds, boxes and courses of ships are too many: keep at most {}", shown,
                        boxes, most_boxes));
    in.finish();
    return scene;
}

}  // namespace trochoid
