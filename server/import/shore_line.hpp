#pragma once

#include <filesystem>
#include <vector>

#include "server/import/map_projection.hpp"

namespace trochoid {

/// A closed line on the map, metres east and north of the origin; the last point joins the first (and is not it).
using ShoreRing = std::vector<EastNorth>;

/// The closed lines of a GeoJSON file (RFC 7946: Polygon, MultiPolygon, and closed LineString and MultiLineString,
/// alone, as features or in collections; longitudes in any range). Land is where an odd number of rings is around.
/// Throws OperatorError for an unreadable file, a line that is not closed, and points outside the projection's domain.
std::vector<ShoreRing> read_shore_line(const std::filesystem::path& path, const WorldMap& map);

}  // namespace trochoid
