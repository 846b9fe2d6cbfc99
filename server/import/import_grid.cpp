#include "server/import/import_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "protocol/units/lattice.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {
namespace {

constexpr double lowest_height = -12'000.0;
constexpr double highest_height = 9'000.0;
constexpr double side_cells_max = 16'384.0;
constexpr int32_t height_step_log2_min = 5;

uint32_t spacing_log2_of(double metres) {
    for (uint32_t log2 = 0; log2 <= 20; ++log2)
        if (metres * static_cast<double>(lattice_per_metre) == static_cast<double>(int64_t{1} << log2))
            return log2;
    throw OperatorError(fmt::format(
        "a spacing of {} m is no power of two between 1/1024 and 1024 m: give 4, 8, 16, 32, 64, ...",
        metres));
}

/// Cells along a side, at least one.
uint32_t cells_along(const char* side, double metres, double spacing) {
    const double cells = std::round(metres / spacing);
    if (!(cells >= 1.0))
        throw OperatorError(
            fmt::format("a grid of {} m {} is smaller than its spacing of {} m: give a larger --extent",
                        metres, side, spacing));
    if (cells > side_cells_max)
        throw OperatorError(fmt::format(
            "a grid of {} m {} has {:.0f} cells at a spacing of {} m, more than 16,384: give a coarser --spacing or a "
            "smaller --extent",
            metres, side, cells, spacing));
    return static_cast<uint32_t>(cells);
}

double sample_metres(const TerrainGrid& grid, std::size_t index) {
    return std::ldexp(grid.heights[index], grid.height_step_log2) / static_cast<double>(lattice_per_metre);
}

bool on_border(const TerrainGrid& grid, std::size_t index) {
    const std::size_t column = index % grid.columns;
    const std::size_t row = index / grid.columns;
    return column == 0 || row == 0 || column + 1 == grid.columns || row + 1 == grid.rows;
}

double mean_border_depth(const TerrainGrid& grid) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < grid.heights.size(); ++i) {
        if (grid.heights[i] >= 0 || !on_border(grid, i)) continue;
        sum -= sample_metres(grid, i);
        ++count;
    }
    return count == 0 ? 60.0 : sum / static_cast<double>(count);
}

}  // namespace

TerrainGrid plan_grid(const GridRequest& request, const WorldMap& map) {
    TerrainGrid grid;
    grid.spacing_log2 = spacing_log2_of(request.spacing);
    const uint32_t across = cells_along("wide", request.width, request.spacing);
    const uint32_t down = cells_along("high", request.height, request.spacing);
    grid.columns = across + 1;
    grid.rows = down + 1;
    const int64_t spacing = int64_t{1} << grid.spacing_log2;
    grid.origin_x = -int64_t{across / 2} * spacing;
    grid.origin_z = -int64_t{down / 2} * spacing;
    grid.projection = map.proj_string();
    grid.origin_lon = wrap_degrees(map.origin().lon);
    grid.origin_lat = map.origin().lat;
    return grid;
}

std::vector<LonLat> sample_places(const TerrainGrid& grid, const WorldMap& map) {
    std::vector<LonLat> places;
    places.reserve(std::size_t{grid.columns} * grid.rows);
    const int64_t spacing = int64_t{1} << grid.spacing_log2;
    for (int64_t row = 0; row < grid.rows; ++row) {
        for (int64_t column = 0; column < grid.columns; ++column) {
            const double east = to_metres(grid.origin_x + column * spacing);
            const double south = to_metres(grid.origin_z + row * spacing);
            const LonLat place = map.to_lon_lat({east, -south});
            if (!std::isfinite(place.lon) || !std::isfinite(place.lat))
                throw OperatorError(fmt::format(
                    "the projection \"{}\" ends inside the grid ({:.0f} m east, {:.0f} m south of the "
                    "origin): give a smaller --extent or another --projection",
                    map.proj_string(), east, south));
            places.push_back(place);
        }
    }
    return places;
}

void store_heights(TerrainGrid& grid, const std::vector<double>& metres) {
    double reach = 0.0;
    for (const double height : metres) {
        if (!(height >= lowest_height && height <= highest_height))
            throw OperatorError(fmt::format(
                "a height of {:.6g} m is outside -12,000..9,000 m: if it marks missing data, give it as "
                "--nodata; if heights are not in metres, convert them first",
                height));
        reach = std::max(reach, std::fabs(height));
    }
    int32_t step_log2 = height_step_log2_min;
    while (reach * static_cast<double>(lattice_per_metre) > std::ldexp(32'767.0, step_log2)) ++step_log2;
    grid.height_step_log2 = step_log2;
    grid.heights.clear();
    grid.heights.reserve(metres.size());
    const double counts_per_metre = std::ldexp(static_cast<double>(lattice_per_metre), -step_log2);
    for (const double height : metres)
        grid.heights.push_back(static_cast<int16_t>(std::lround(height * counts_per_metre)));
}

void set_open_sea(TerrainGrid& grid, double depth) {
    const double metres = depth == 0.0 ? mean_border_depth(grid) : depth;
    if (!(metres >= 1.0 / static_cast<double>(lattice_per_metre) && metres <= -lowest_height))
        throw OperatorError(fmt::format(
            "an open-sea depth of {} m is outside 0..12,000 m: give another --open-depth", metres));
    grid.open_sea_depth = static_cast<int32_t>(-to_lattice(metres));
}

ImportReport describe_heights(const TerrainGrid& grid) {
    ImportReport report;
    std::size_t land = 0;
    report.lowest = report.highest = sample_metres(grid, 0);
    for (std::size_t i = 0; i < grid.heights.size(); ++i) {
        const double metres = sample_metres(grid, i);
        report.lowest = std::min(report.lowest, metres);
        report.highest = std::max(report.highest, metres);
        if (grid.heights[i] > 0) ++land;
    }
    report.land_share = static_cast<double>(land) / static_cast<double>(grid.heights.size());
    return report;
}

}  // namespace trochoid
