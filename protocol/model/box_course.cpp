#include "protocol/model/box_course.hpp"

#include <algorithm>

#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

LatticePoint corner_on(const CourseLeg& leg, SeaTime t) {
    // |v| < 2^21 and at most 2^41 us, so each product stays below 2^62.
    const int64_t moved_us = std::clamp<int64_t>(t - leg.from, 0, leg.duration_us);
    return {leg.origin.x + ((leg.vx * moved_us) >> 24), leg.origin.z + ((leg.vz * moved_us) >> 24)};
}

Result<Done> range_error(const char* message) { return Error{ErrorCode::value_out_of_range, message}; }

}  // namespace

LatticePoint corner_at(std::span<const CourseLeg> legs, SeaTime t) {
    TROCHOID_ASSERT(!legs.empty(), "a course without legs");
    const auto next = std::upper_bound(legs.begin(), legs.end(), t,
                                       [](SeaTime at, const CourseLeg& leg) { return at < leg.from; });
    return corner_on(next == legs.begin() ? *next : *(next - 1), t);
}

Result<Done> validate(std::span<const CourseLeg> legs) {
    if (legs.size() > most_course_legs) return range_error("a course has more than 64 legs");
    for (size_t i = 0; i < legs.size(); ++i) {
        const CourseLeg& leg = legs[i];
        if (leg.from.us < -sea_time_bound || leg.from.us > sea_time_bound)
            return range_error("a course leg's beginning is not within 2^61 us");
        if (i > 0 && leg.from <= legs[i - 1].from)
            return range_error("a course's legs do not ascend by their beginnings");
        if (leg.duration_us < 0 || leg.duration_us > longest_leg_us)
            return range_error("a course leg does not last 0 to 2^41 us (25 days)");
        for (const int32_t v : {leg.vx, leg.vz})
            if (v <= -fastest_leg || v >= fastest_leg)
                return range_error("a course leg's velocity is not below 122 m/s in each component");
        if (!inside_world(leg.origin) || !inside_world(corner_on(leg, leg.from + leg.duration_us)))
            return range_error("a course leaves the world (|x|, |z| <= 2^35 lattice units)");
    }
    return Done{};
}

}  // namespace trochoid
