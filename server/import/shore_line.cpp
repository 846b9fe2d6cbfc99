#include "server/import/shore_line.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "protocol/units/operator_error.hpp"

namespace trochoid {
namespace {

using Json = nlohmann::json;

class RingCollector {
public:
    RingCollector(const std::filesystem::path& path, const WorldMap& map) : path_(path), map_(map) {}

    void add_object(const Json& object) {
        const std::string type = object.at("type").get<std::string>();
        if (type == "FeatureCollection") {
            for (const Json& feature : object.at("features")) add_object(feature);
        } else if (type == "Feature") {
            if (!object.at("geometry").is_null()) add_object(object.at("geometry"));
        } else if (type == "GeometryCollection") {
            for (const Json& geometry : object.at("geometries")) add_object(geometry);
        } else if (type == "Polygon" || type == "MultiLineString") {
            for (const Json& ring : object.at("coordinates")) add_ring(ring);
        } else if (type == "MultiPolygon") {
            for (const Json& polygon : object.at("coordinates"))
                for (const Json& ring : polygon) add_ring(ring);
        } else if (type == "LineString") {
            add_ring(object.at("coordinates"));
        } else {
            throw OperatorError(fmt::format("{}: a {} is no shore line: give polygons or closed lines",
                                            path_.string(), type));
        }
    }

    std::vector<ShoreRing> take() { return std::move(rings_); }

private:
    void add_ring(const Json& points) {
        if (points.size() < 4 || points.front() != points.back())
            throw OperatorError(fmt::format(
                "{}: shore line {} is not closed, so land and sea cannot be told apart: give polygons, or "
                "lines whose last point is the first",
                path_.string(), rings_.size() + 1));
        ShoreRing ring;
        ring.reserve(points.size() - 1);
        // The ring starts on the turn of the origin and goes on without jumps, wherever the file's longitudes wrap.
        double lon = map_.origin().lon;
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            lon += wrap_degrees(points[i].at(0).get<double>() - lon);
            ring.push_back(projected({lon, points[i].at(1).get<double>()}));
        }
        rings_.push_back(std::move(ring));
    }

    EastNorth projected(LonLat place) const {
        const EastNorth point = map_.to_world(place);
        if (!std::isfinite(point.east) || !std::isfinite(point.north))
            throw OperatorError(fmt::format(
                "{}: the projection does not reach {},{}: crop the shore line to the region first",
                path_.string(), place.lon, place.lat));
        return point;
    }

    const std::filesystem::path& path_;
    const WorldMap& map_;
    std::vector<ShoreRing> rings_;
};

}  // namespace

std::vector<ShoreRing> read_shore_line(const std::filesystem::path& path, const WorldMap& map) {
    std::ifstream file(path);
    if (!file || std::filesystem::is_directory(path))
        throw OperatorError(fmt::format("cannot open the shore line {}: check the path", path.string()));
    RingCollector collector(path, map);
    try {
        collector.add_object(Json::parse(file));
    } catch (const Json::exception& error) {
        throw OperatorError(fmt::format("{} is no GeoJSON with polygons ({})", path.string(), error.what()));
    }
    std::vector<ShoreRing> rings = collector.take();
    if (rings.empty())
        throw OperatorError(
            fmt::format("{} holds no shore line: give polygons or closed lines", path.string()));
    return rings;
}

}  // namespace trochoid
