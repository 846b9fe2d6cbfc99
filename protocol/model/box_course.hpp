#pragma once
#include <cstdint>
#include <span>

#include "protocol/units/lattice.hpp"
#include "protocol/units/result.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// Most legs of a course, and longest leg: 2^41 us (25 days), so that position products stay below 2^62.
inline constexpr size_t most_course_legs = 64;
inline constexpr int64_t longest_leg_us = int64_t{1} << 41;
/// Bound of a leg's velocity components: 2^21 of Q.24 lattice units per microsecond (122 m/s).
inline constexpr int32_t fastest_leg = 1 << 21;

/// A straight leg of a moving box's course (row A12): from its beginning the box's corner u = v = 0 moves evenly for
/// `duration_us`, then lies still. Only the envelope moves; wave vectors, phases and land fields stay in the world frame.
struct CourseLeg {
    SeaTime from;
    int64_t duration_us = 0;  ///< 0 to longest_leg_us
    LatticePoint origin;      ///< the corner at `from`
    int32_t vx = 0;           ///< lattice units per microsecond, Q.24 (1 m/s = 17180); |v| < fastest_leg
    int32_t vz = 0;
    bool operator==(const CourseLeg&) const = default;
};

/// The corner at a sea time: origin + ((v * clamp(T - from, 0, duration)) >> 24) of the last leg that has begun by T, of
/// the first where none has. `legs` ascend strictly by `from` and are not empty.
LatticePoint corner_at(std::span<const CourseLeg> legs, SeaTime t);

/// At most most_course_legs, ascending, each in range and inside the world from its beginning to its end.
Result<Done> validate(std::span<const CourseLeg> legs);

}  // namespace trochoid
