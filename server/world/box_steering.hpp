#pragma once
#include <span>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "protocol/model/box_course.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "server/event/scene.hpp"

namespace trochoid {

/// The course of a placed box (row A12) along a scene's legs: each from its time to the next one's, the last to `until`, in pieces of
/// at most longest_leg_us. A box lies still where its corners reach the world's edge. too_many_legs where the pieces are
/// more than most_course_legs.
Result<std::vector<CourseLeg>> course_of(const WaveTrainBox& box, std::span<const SceneLeg> legs,
                                         SeaTime until);

/// A moving box's next leg: from where its corner is at `effective`, at `speed` m/s towards a heading in degrees; it lasts 25 days, or until
/// the world's edge. not_moving for a box without a course, too_many_legs where its course is full, value_out_of_range.
Result<CourseLeg> next_leg(const WaveTrainBox& box, SeaTime effective, double towards_degrees, double speed);

/// The box with the leg in its course: it takes the place of all legs that would begin with it or later.
void steer(WaveTrainBox& box, const CourseLeg& leg);

}  // namespace trochoid
