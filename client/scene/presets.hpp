#pragma once
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "client/scene/camera.hpp"
#include "client/scene/draw_options.hpp"

namespace trochoid {

/// A weather worth looking at: a scene for the server, and whence and when to look at it.
struct Preset {
    std::string_view name;   ///< calm, breeze, gale, storm, harbour
    std::string_view scene;  ///< file for `trochoid-server --scene`, relative to the repository's root
    std::string_view shows;  ///< one line for people
    std::array<double, 5>
        camera{};      ///< as --camera: metres east, up, south; degrees clockwise from north, upwards
    double hour = 12;  ///< local solar time
    Quality quality = Quality::medium;
};

std::span<const Preset> presets();
std::optional<Preset> preset_named(std::string_view name);

/// Sets camera, hour and quality; size and opening angle of the camera stay, and all other options.
void apply(const Preset& preset, Camera& camera, DrawOptions& options);

}  // namespace trochoid
