#pragma once

#include <string>
#include <vector>

#include "protocol/model/terrain.hpp"
#include "server/import/map_projection.hpp"

namespace trochoid {

/// Where the imported grid lies and how fine it is; shared by all importers.
struct GridRequest {
    LonLat origin;
    std::string projection = "tmerc";
    /// Metres between samples: a power of two, 1/1024..1024.
    double spacing = 32.0;
    /// Metres from west to east and from north to south, centred on the origin; rounded to whole cells.
    double width = 0.0;
    double height = 0.0;
};

/// What an import did, for the operator.
struct ImportReport {
    double lowest = 0.0;      ///< metres, negative below sea level
    double highest = 0.0;     ///< metres
    double land_share = 0.0;  ///< share of samples above sea level, 0..1
    /// Sentences about what was assumed, filled or left out.
    std::vector<std::string> notes;
};

/// A terrain with its report.
struct ImportedTerrain {
    TerrainGrid grid;
    ImportReport report;
};

/// The grid's geometry without heights. Throws OperatorError for absurd sizes, spacings and origins.
TerrainGrid plan_grid(const GridRequest& request, const WorldMap& map);

/// Longitude and latitude of every sample, row-major. Throws OperatorError where the projection ends inside the grid.
std::vector<LonLat> sample_places(const TerrainGrid& grid, const WorldMap& map);

/// Writes heights (metres, positive up, row-major) into the grid with the finest height step >= 1/32 m that holds them.
/// Throws OperatorError for a height that is not finite or outside -12,000..9,000 m.
void store_heights(TerrainGrid& grid, const std::vector<double>& metres);

/// Sets the open sea's depth: the given one (metres, > 0), or where it is 0 the mean depth of the border's sea samples
/// (60 m where the border has none). Throws OperatorError for one outside 1/1024..12,000 m.
void set_open_sea(TerrainGrid& grid, double depth);

/// Lowest, highest and land share of a finished grid.
ImportReport describe_heights(const TerrainGrid& grid);

}  // namespace trochoid
