#pragma once
#include <cstdint>
#include <vector>

#include "protocol/model/wave_train_box.hpp"

namespace trochoid {

/// Sets u to the heading and the corner so that the middle of the rear edge lies at `rear_middle`. The box's sides must be set.
void place(WaveTrainBox& box, double towards_degrees, LatticePoint rear_middle);

/// Whether all four corners lie in the world; unlimited sides count as 0.
bool corners_inside_world(const WaveTrainBox& box);

/// m/s as lattice units per microsecond in Q.24, of a leading edge and of a course.
uint32_t front_speed_of(double metres_per_second);
int32_t course_speed_of(double metres_per_second);

/// Even motion of a placed box (row A12) from `from` on, up to `until` at most: legs of longest_leg_us (25 days) one after the
/// other, at most most_course_legs (4.4 years). The motion ends, and the box lies still from there on, where the legs are
/// used up or a corner would leave the world. Empty where vx = vz = 0. Components below fastest_leg; the box inside the world.
std::vector<CourseLeg> even_course(const WaveTrainBox& box, SeaTime from, SeaTime until, int32_t vx,
                                   int32_t vz);

}  // namespace trochoid
