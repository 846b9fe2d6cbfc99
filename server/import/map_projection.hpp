#pragma once

#include <memory>
#include <string>
#include <string_view>

struct pj_ctx;
struct PJconsts;

namespace trochoid {

/// Degrees, WGS 84 (or whatever datum the source has: the importer shifts none).
struct LonLat {
    double lon = 0.0;
    double lat = 0.0;
};

/// Metres on a map.
struct EastNorth {
    double east = 0.0;
    double north = 0.0;
};

/// The same angle in -180 (inclusive) .. 180 (exclusive) degrees.
double wrap_degrees(double degrees);

/// A projection of libproj as a pair of functions. Points outside its domain come back as infinities.
class ProjConversion {
public:
    /// Takes a PROJ string of a projection ("+proj=utm +zone=30 +datum=WGS84"). Throws OperatorError where libproj
    /// does not know it or it does not turn longitude and latitude into map coordinates.
    explicit ProjConversion(const std::string& proj_string);
    ~ProjConversion();
    ProjConversion(const ProjConversion&) = delete;
    ProjConversion& operator=(const ProjConversion&) = delete;

    EastNorth forward(LonLat place) const;
    LonLat inverse(EastNorth point) const;

private:
    pj_ctx* context_ = nullptr;
    PJconsts* conversion_ = nullptr;
};

/// The PROJ string for a short name (tmerc, laea, eqc, stere, utm), centred on the origin; a text that begins with
/// "+proj=" is taken as it stands. Throws OperatorError for any other name.
std::string projection_string(std::string_view name, LonLat origin);

/// Longitude and latitude to metres east and north of an origin.
class WorldMap {
public:
    /// Throws OperatorError for an unknown projection, an origin outside its domain, and a projection whose unit near
    /// the origin is not roughly a metre on the ground (within a factor of three).
    WorldMap(std::string_view projection_name, LonLat origin);

    const std::string& proj_string() const { return proj_string_; }
    LonLat origin() const { return origin_; }
    EastNorth to_world(LonLat place) const;
    LonLat to_lon_lat(EastNorth point) const;

private:
    LonLat origin_;
    std::string proj_string_;
    ProjConversion conversion_;
    /// Where the projection puts the origin (utm's false easting, for one).
    EastNorth offset_;
};

}  // namespace trochoid
