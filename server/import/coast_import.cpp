#include "server/import/coast_import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "protocol/units/lattice.hpp"
#include "protocol/units/operator_error.hpp"
#include "server/import/shore_distance.hpp"

namespace trochoid {
namespace {

void check_ranges(const CoastRequest& request) {
    const auto require = [](bool kept, std::string_view option, double value, std::string_view range) {
        if (!kept) throw OperatorError(fmt::format("{} {} is out of range: give {}", option, value, range));
    };
    const double a = request.dean_a;
    require(a >= 0.01 && a <= 1.0, "--dean-a", a, "0.01..1 m^(1/3), for instance 0.1 for fine sand");
    const double depth = request.max_depth;
    require(depth >= 1.0 && depth <= 1000.0, "--max-depth", depth, "1..1000 m");
    require(request.land.top >= 1.0 && request.land.top <= 1000.0, "--land-top", request.land.top,
            "1..1000 m");
    if (request.source.size() > 2000)
        throw OperatorError("--source is longer than 2000 bytes: give a shorter one");
    require(request.land.slope >= 0.001 && request.land.slope <= 2.0, "--land-slope", request.land.slope,
            "0.001..2");
}

std::string provenance_of(const CoastRequest& request) {
    return fmt::format(
        "Shore line: {}. Depth synthetic: Dean (1977) profile, A = {} m^(1/3), at most {} m. Land height synthetic: "
        "at most {} m, slope {}, seed {}.",
        request.source, request.dean_a, request.max_depth, request.land.top, request.land.slope,
        request.land.seed);
}

}  // namespace

ImportedTerrain import_coast(const std::filesystem::path& shore_line, const CoastRequest& request) {
    check_ranges(request);
    const WorldMap map(request.grid.projection, request.grid.origin);
    ImportedTerrain result;
    TerrainGrid& grid = result.grid;
    grid = plan_grid(request.grid, map);
    const std::vector<ShoreRing> rings = read_shore_line(shore_line, map);
    const LandMask mask = land_mask(grid, rings);
    const ShoreDistance shore(rings);

    // One count, so that rounding cannot turn land into sea or back.
    const double least = std::ldexp(1.0, 5) / static_cast<double>(lattice_per_metre);
    const int64_t spacing = int64_t{1} << grid.spacing_log2;
    std::vector<double> metres;
    metres.reserve(mask.land.size());
    for (int64_t row = 0; row < grid.rows; ++row) {
        for (int64_t column = 0; column < grid.columns; ++column) {
            const EastNorth place{to_metres(grid.origin_x + column * spacing),
                                  -to_metres(grid.origin_z + row * spacing)};
            const double from_shore = shore.at(place);
            const bool land = mask.land[metres.size()] != 0;
            const double height =
                land ? synthetic_land_height(request.land, from_shore, place)
                     : -capped_depth(dean_depth(request.dean_a, from_shore), request.max_depth);
            metres.push_back(land ? std::max(least, height) : std::min(-least, height));
        }
    }
    store_heights(grid, metres);
    set_open_sea(grid, request.max_depth);
    grid.provenance = provenance_of(request);

    result.report = describe_heights(grid);
    result.report.notes.push_back(fmt::format("{} shore lines read", rings.size()));
    if (mask.rings_without_sample > 0)
        result.report.notes.push_back(
            fmt::format("{} islets hold no sample and became shoals: a finer --spacing shows them",
                        mask.rings_without_sample));
    result.report.notes.emplace_back(
        "depth and land height are synthetic, made from the distance to the shore");
    return result;
}

}  // namespace trochoid
