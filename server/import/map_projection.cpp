#include "server/import/map_projection.hpp"

#include <fmt/format.h>
#include <proj.h>

#include <cmath>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

double wrap_degrees(double degrees) { return degrees - 360.0 * std::floor((degrees + 180.0) / 360.0); }

ProjConversion::ProjConversion(const std::string& proj_string) : context_(proj_context_create()) {
    // Its reasons go into our message instead of to standard error.
    proj_log_level(context_, PJ_LOG_NONE);
    conversion_ = proj_create(context_, proj_string.c_str());
    const bool known = conversion_ != nullptr;
    const bool from_angles = known && proj_angular_input(conversion_, PJ_FWD) != 0;
    const bool to_map = known && proj_angular_output(conversion_, PJ_FWD) == 0;
    if (known && from_angles && to_map) return;
    const char* reason = known ? nullptr : proj_context_errno_string(context_, proj_context_errno(context_));
    const std::string why = reason ? reason : "it does not turn longitude and latitude into metres";
    proj_destroy(conversion_);
    proj_context_destroy(context_);
    throw OperatorError(fmt::format(
        "unknown projection \"{}\" ({}): give tmerc, laea, eqc, stere, utm or a PROJ string that begins "
        "with +proj=",
        proj_string, why));
}

ProjConversion::~ProjConversion() {
    proj_destroy(conversion_);
    proj_context_destroy(context_);
}

EastNorth ProjConversion::forward(LonLat place) const {
    const PJ_COORD from = proj_coord(proj_torad(place.lon), proj_torad(place.lat), 0.0, 0.0);
    const PJ_COORD to = proj_trans(conversion_, PJ_FWD, from);
    // One point out of the domain must not condemn the next.
    proj_errno_reset(conversion_);
    return {to.xy.x, to.xy.y};
}

LonLat ProjConversion::inverse(EastNorth point) const {
    const PJ_COORD to = proj_trans(conversion_, PJ_INV, proj_coord(point.east, point.north, 0.0, 0.0));
    proj_errno_reset(conversion_);
    return {proj_todeg(to.lp.lam), proj_todeg(to.lp.phi)};
}

std::string projection_string(std::string_view name, LonLat origin) {
    if (name.size() > 1000) throw OperatorError("--projection is longer than 1000 bytes: give a shorter one");
    if (name.substr(0, 6) == "+proj=") return std::string(name);
    const std::string centre = fmt::format("+lat_0={} +lon_0={}", origin.lat, origin.lon);
    const std::string_view tail = "+x_0=0 +y_0=0 +ellps=WGS84 +units=m";
    if (name == "tmerc" || name == "stere") return fmt::format("+proj={} {} +k=1 {}", name, centre, tail);
    if (name == "laea") return fmt::format("+proj=laea {} {}", centre, tail);
    if (name == "eqc") return fmt::format("+proj=eqc +lat_ts={} {} {}", origin.lat, centre, tail);
    if (name == "utm") {
        const int zone = static_cast<int>(std::floor((wrap_degrees(origin.lon) + 180.0) / 6.0)) + 1;
        return fmt::format("+proj=utm +zone={}{} +ellps=WGS84 +units=m", zone,
                           origin.lat < 0.0 ? " +south" : "");
    }
    throw OperatorError(fmt::format(
        "unknown projection \"{}\": give tmerc, laea, eqc, stere, utm or a PROJ string that begins with +proj=",
        name));
}

WorldMap::WorldMap(std::string_view projection_name, LonLat origin)
    : origin_(origin),
      proj_string_(projection_string(projection_name, origin)),
      conversion_(proj_string_),
      offset_(conversion_.forward(origin)) {
    if (!std::isfinite(offset_.east) || !std::isfinite(offset_.north))
        throw OperatorError(
            fmt::format("the projection \"{}\" does not reach the origin {},{}: choose another one",
                        proj_string_, origin.lon, origin.lat));
    // A thousandth of a degree of latitude is about 111 m; towards the equator, so that it also works at a pole.
    const double step = origin.lat > 0.0 ? -0.001 : 0.001;
    const EastNorth near = to_world({origin.lon, origin.lat + step});
    const double ratio = std::hypot(near.east, near.north) / 111.0;
    if (!(ratio > 1.0 / 3.0 && ratio < 3.0))
        throw OperatorError(fmt::format(
            "the projection \"{}\" makes {:.4g} m of a metre on the ground at the origin: choose one in "
            "metres that suits the place (tmerc does everywhere)",
            proj_string_, ratio));
}

EastNorth WorldMap::to_world(LonLat place) const {
    const EastNorth map = conversion_.forward(place);
    return {map.east - offset_.east, map.north - offset_.north};
}

LonLat WorldMap::to_lon_lat(EastNorth point) const {
    return conversion_.inverse({point.east + offset_.east, point.north + offset_.north});
}

}  // namespace trochoid
