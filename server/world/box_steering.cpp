#include "server/world/box_steering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/event/wind_limits.hpp"
#include "server/world/box_placement.hpp"
#include "server/world/integer_math.hpp"

namespace trochoid {

namespace {

struct Velocity {
    int32_t vx = 0;
    int32_t vz = 0;
};

Velocity velocity_of(double towards_degrees, double speed) {
    const HeadingVector u = heading_vector(towards_degrees);
    return {course_speed_of(speed * u.east), course_speed_of(speed * u.south)};
}

/// Legs from `corner` on; one that stands still too.
std::vector<CourseLeg> legs_from(const WaveTrainBox& box, LatticePoint corner, SeaTime from, SeaTime until,
                                 Velocity v) {
    WaveTrainBox there = box;
    there.origin = corner;
    std::vector<CourseLeg> legs = even_course(there, from, until, v.vx, v.vz);
    if (legs.empty()) legs.push_back({from, 0, corner, 0, 0});
    return legs;
}

Error too_many(BoxId box) {
    return {ErrorCode::too_many_legs,
            fmt::format(
                "box {} has {} legs of its course, as many as there may be: start another one, and stop it",
                box.value, most_course_legs)};
}

}  // namespace

Result<std::vector<CourseLeg>> course_of(const WaveTrainBox& box, std::span<const SceneLeg> legs,
                                         SeaTime until) {
    std::vector<CourseLeg> course;
    LatticePoint corner = box.origin;
    for (size_t i = 0; i < legs.size(); ++i) {
        const SeaTime end = i + 1 < legs.size() ? legs[i + 1].at : std::max(until, legs[i].at);
        const auto pieces =
            legs_from(box, corner, legs[i].at, end, velocity_of(legs[i].towards_degrees, legs[i].speed));
        std::copy(pieces.begin(), pieces.end(), std::back_inserter(course));
        const bool last = i + 1 == legs.size();
        if (course.size() > most_course_legs && last) course.resize(most_course_legs);
        if (course.size() > most_course_legs) return too_many(box.id);
        corner = corner_at(course, end);
    }
    return course;
}

Result<CourseLeg> next_leg(const WaveTrainBox& box, SeaTime effective, double towards_degrees, double speed) {
    // Each comparison is written so that NaN is refused too.
    if (!(towards_degrees >= 0.0 && towards_degrees < 360.0))
        return Error{ErrorCode::value_out_of_range,
                     fmt::format("the course is {} degrees: give 0 to below 360, clockwise from north",
                                 towards_degrees)};
    if (!(speed >= 0.0 && speed <= static_cast<double>(fastest_storm)))
        return Error{ErrorCode::value_out_of_range,
                     fmt::format("the speed is {} m/s: give 0 (lie still) to {}", speed, fastest_storm)};
    if (box.course.empty())
        return Error{
            ErrorCode::not_moving,
            fmt::format("box {} lies still for good: only ships and winds that were started with a velocity "
                        "can be steered",
                        box.id.value)};
    const auto kept = std::count_if(box.course.begin(), box.course.end(),
                                    [&](const CourseLeg& leg) { return leg.from < effective; });
    if (static_cast<size_t>(kept) >= most_course_legs) return too_many(box.id);
    const SeaTime until{std::min(effective.us + longest_leg_us, sea_time_bound)};
    return legs_from(box, corner_at(box.course, effective), effective, until,
                     velocity_of(towards_degrees, speed))
        .front();
}

void steer(WaveTrainBox& box, const CourseLeg& leg) {
    std::erase_if(box.course, [&](const CourseLeg& old) { return old.from >= leg.from; });
    box.course.push_back(leg);
    box.origin = box.course.front().origin;
}

}  // namespace trochoid
