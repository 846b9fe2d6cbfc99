#pragma once

#include <filesystem>

#include "server/import/coast_profile.hpp"
#include "server/import/import_grid.hpp"

namespace trochoid {

/// How depth and land are made where only the shore line is known.
struct CoastRequest {
    GridRequest grid;
    /// Dean's A, m^(1/3).
    double dean_a = 0.1;
    /// Metres that no depth exceeds; also the open sea's depth.
    double max_depth = 60.0;
    LandShape land;
    /// Where the shore line comes from; goes into the terrain's provenance.
    std::string source;
};

/// Makes a terrain from a GeoJSON shore line (read_shore_line): even-odd land mask, exact distance to the shore,
/// capped Dean profile outwards, synthetic land inwards. Land samples are at least one count above 0, sea samples at
/// least one below. The shore line must reach as far beyond the extent as its distances matter. Throws OperatorError.
ImportedTerrain import_coast(const std::filesystem::path& shore_line, const CoastRequest& request);

}  // namespace trochoid
