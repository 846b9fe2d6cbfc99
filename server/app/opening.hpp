#pragma once
#include <filesystem>
#include <memory>

#include "protocol/model/terrain.hpp"
#include "server/event/scene.hpp"
#include "server/land/land_settings.hpp"

namespace trochoid {

/// The terrain of a file of trochoid-import; nullptr for an empty path. Throws OperatorError.
std::shared_ptr<const TerrainGrid> load_terrain(const std::filesystem::path& file);

/// The tracer's settings as a scene asks for them. Throws OperatorError for what the tracer does not take.
LandSettings land_settings_of(const SceneLand& land);

}  // namespace trochoid
