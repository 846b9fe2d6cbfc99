#include "client/scene/presets.hpp"

namespace trochoid {

namespace {

constexpr double radians_per_degree = 0.017453292519943295;

constexpr std::array<Preset, 5> table{{
    {"calm",
     "server/scenes/breeze-2/scene.toml",
     "light air over a glassy sea towards the evening sun",
     {0, 4, 0, 268, -6},
     18.2,
     Quality::medium},
    {"breeze",
     "server/scenes/scilly/scene.toml",
     "a fresh breeze off the Isles of Scilly",
     {-9000, 14, 5000, 60, -3},
     10.0,
     Quality::medium},
    {"gale",
     "server/scenes/pierson-moskowitz/scene.toml",
     "a gale: whitecaps in rows, broken sky",
     {0, 10, 0, 235, -4},
     16.0,
     Quality::medium},
    {"storm",
     "server/scenes/storm-40/scene.toml",
     "a hurricane: streaks of foam, spray, a closed grey sky",
     {0, 30, 0, 250, -9},
     13.5,
     Quality::medium},
    {"harbour",
     "server/scenes/harbour/scene.toml",
     "swell that bends into a harbour behind two moles",
     {-160, 30, 420, 25, -7},
     9.0,
     Quality::medium},
}};

}  // namespace

std::span<const Preset> presets() { return table; }

std::optional<Preset> preset_named(std::string_view name) {
    for (const Preset& preset : table)
        if (preset.name == name) return preset;
    return std::nullopt;
}

void apply(const Preset& preset, Camera& camera, DrawOptions& options) {
    camera.position = {};
    camera.fraction_x = camera.fraction_z = 0;
    move(camera, preset.camera[0], preset.camera[1] - camera.altitude_m, preset.camera[2]);
    camera.yaw = preset.camera[3] * radians_per_degree;
    camera.pitch = preset.camera[4] * radians_per_degree;
    options.hour = preset.hour;
    set_quality(options, preset.quality);
}

}  // namespace trochoid
