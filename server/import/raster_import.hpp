#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/import/import_grid.hpp"

namespace trochoid {

/// Sign of the raster's values: heights above (up) or depths below (down) the sea. `automatic` believes the file's own
/// description, then takes values of which some are negative as positive up, and refuses all-positive ones.
enum class RasterSign { automatic, up, down };

struct RasterRequest {
    GridRequest grid;
    RasterSign sign = RasterSign::automatic;
    /// Value that marks missing samples; instead of the file's own nodata tag.
    std::optional<double> nodata;
    /// Metres; 0 takes the mean depth along the grid's border.
    double open_depth = 0.0;
    /// The netCDF variable with the heights; empty chooses.
    std::string variable;
};

/// Projects a raster of heights or depths in metres (open_raster: GeoTIFF, netCDF, PNG with sidecar) onto the grid, bilinearly. Longitudes may run -180..180 or
/// 0..360, the place may lie across the raster's seam, rows may run north or south, pixels be areas or points;
/// projected rasters work where PROJ knows the projection. Missing samples are filled from their neighbours. Datum shifts are
/// not applied. Throws OperatorError where the place reaches beyond the raster, more than half of the samples
/// there are missing, or anything about the file is unclear.
ImportedTerrain import_raster(const std::filesystem::path& raster, const RasterRequest& request);

/// Fills NaN samples ring by ring: each from the mean of those of its eight neighbours that had a value before the ring.
/// Returns how many were filled; leaves samples that are all NaN as they are.
std::size_t fill_missing(std::vector<float>& samples, int64_t columns, int64_t rows);

}  // namespace trochoid
