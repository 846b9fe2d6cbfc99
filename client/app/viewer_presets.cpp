#include "client/app/viewer_presets.hpp"

#include <fmt/format.h>

#include "client/scene/presets.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

std::string preset_names() {
    std::string names;
    for (const Preset& preset : presets())
        names += fmt::format("{}{}", names.empty() ? "" : ", ", preset.name);
    return names;
}

void take_preset(const std::string& name, ViewerOptions& options) {
    const auto preset = preset_named(name);
    if (!preset) throw OperatorError(fmt::format("--preset {}: there are {}.", name, preset_names()));
    apply(*preset, options.camera, options.draw);
    options.quality = preset->quality;
    options.preset = name;
}

void next_preset(std::string& name, FlyCamera& fly, DrawOptions& draw, Quality& quality) {
    const auto all = presets();
    size_t next = 0;
    for (size_t i = 0; i < all.size(); ++i)
        if (all[i].name == name) next = (i + 1) % all.size();
    Camera camera = fly.camera();
    apply(all[next], camera, draw);
    fly.go_to(camera);
    quality = all[next].quality;
    name = all[next].name;
}

std::string preset_list() {
    std::string text;
    for (const Preset& preset : presets())
        text += fmt::format("{}\t{}\t{}\n", preset.name, preset.scene, preset.shows);
    return text;
}

}  // namespace trochoid
