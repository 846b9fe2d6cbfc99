#pragma once

#include <filesystem>

#include "protocol/model/terrain.hpp"

namespace trochoid {

/// Writes a PNG map, one pixel a sample, north up: sea in blues by depth, land in greens and browns by height, lit from
/// the north-west with the relief exaggerated. Throws OperatorError where the file cannot be written.
void write_picture(const std::filesystem::path& path, const TerrainGrid& grid);

}  // namespace trochoid
