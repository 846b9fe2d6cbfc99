#pragma once
#include <string>

#include "client/app/viewer_options.hpp"
#include "client/scene/fly_camera.hpp"

namespace trochoid {

/// "calm, breeze, gale, storm, harbour"
std::string preset_names();

/// Camera, light and quality of a preset. Throws OperatorError that names what there is.
void take_preset(const std::string& name, ViewerOptions& options);

/// The one after `name` (the first after none): sets the name and takes over camera, light and quality.
void next_preset(std::string& name, FlyCamera& fly, DrawOptions& draw, Quality& quality);

/// A line for each preset: name, scene file and what it shows, parted by tabs, for scripts.
std::string preset_list();

}  // namespace trochoid
