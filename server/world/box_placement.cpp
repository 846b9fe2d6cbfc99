#include "server/world/box_placement.hpp"

#include <algorithm>
#include <array>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"
#include "server/world/integer_math.hpp"

namespace trochoid {

namespace {

constexpr double unit_q30 = 0x1p30;
/// Lattice units per microsecond in Q.24 of 1 m/s.
constexpr double speed_unit = 1024.0 * 0x1p24 / 1e6;

int64_t nearest(double value) { return static_cast<int64_t>(value < 0.0 ? value - 0.5 : value + 0.5); }

std::array<LatticePoint, 4> corners_of(const WaveTrainBox& box) {
    std::array<LatticePoint, 4> corners{};
    size_t at = 0;
    for (const int64_t u : {int64_t{0}, box.length})
        for (const int64_t v : {int64_t{0}, box.width})
            corners[at++] = {box.origin.x + ((u * box.ux - v * box.uz) >> 30),
                             box.origin.z + ((u * box.uz + v * box.ux) >> 30)};
    return corners;
}

/// Microseconds for which a coordinate may move at `speed` before it reaches the world's bound; two units are kept for rounding.
int64_t time_to_bound(int64_t coordinate, int64_t speed) {
    if (speed == 0) return sea_time_bound;
    const int64_t way = world_bound - 2 + (speed > 0 ? -coordinate : coordinate);
    if (way <= 0) return 0;
    return (way << 24) / (speed > 0 ? speed : -speed);
}

}  // namespace

void place(WaveTrainBox& box, double towards_degrees, LatticePoint rear_middle) {
    const HeadingVector u = heading_vector(towards_degrees);
    box.ux = static_cast<int32_t>(nearest(u.east * unit_q30));
    box.uz = static_cast<int32_t>(nearest(u.south * unit_q30));
    // v = (-uz, ux)
    const int64_t half = box.width / 2;
    box.origin = {rear_middle.x + ((box.uz * half) >> 30), rear_middle.z - ((box.ux * half) >> 30)};
}

bool corners_inside_world(const WaveTrainBox& box) {
    const auto corners = corners_of(box);
    return std::all_of(corners.begin(), corners.end(), inside_world);
}

uint32_t front_speed_of(double metres_per_second) {
    return static_cast<uint32_t>(nearest(metres_per_second * speed_unit));
}

int32_t course_speed_of(double metres_per_second) {
    return static_cast<int32_t>(nearest(metres_per_second * speed_unit));
}

std::vector<CourseLeg> even_course(const WaveTrainBox& box, SeaTime from, SeaTime until, int32_t vx,
                                   int32_t vz) {
    TROCHOID_ASSERT(vx > -fastest_leg && vx < fastest_leg && vz > -fastest_leg && vz < fastest_leg,
                    "a course of {}, {} units", vx, vz);
    std::vector<CourseLeg> legs;
    if (vx == 0 && vz == 0) return legs;
    int64_t left = until.us - from.us;
    for (const LatticePoint corner : corners_of(box))
        left = std::min({left, time_to_bound(corner.x, vx), time_to_bound(corner.z, vz)});
    CourseLeg leg{from, 0, box.origin, vx, vz};
    do {
        leg.duration_us = std::clamp(left, int64_t{0}, longest_leg_us);
        legs.push_back(leg);
        leg.from = leg.from + leg.duration_us;
        leg.origin.x += (vx * leg.duration_us) >> 24;
        leg.origin.z += (vz * leg.duration_us) >> 24;
        left -= leg.duration_us;
    } while (left > 0 && legs.size() < most_course_legs);
    return legs;
}

}  // namespace trochoid
