#pragma once

#include <filesystem>

#include "protocol/model/terrain.hpp"

namespace trochoid {

/// Reads a `.terrain` file (protocol/model/terrain_file.hpp). Throws OperatorError naming the file and what to do.
TerrainGrid read_terrain(const std::filesystem::path& path);

/// Writes one beside the target and renames it into place, so that a reader never sees half a file. Throws OperatorError.
void write_terrain(const std::filesystem::path& path, const TerrainGrid& grid);

}  // namespace trochoid
