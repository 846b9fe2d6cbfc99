#include <algorithm>

#include "protocol/model/wave_train_box.hpp"

namespace trochoid {

namespace {

/// Widens the rectangle by the box as it lies with its corner at `origin`.
void add_box_at(LatticeRect& r, const WaveTrainBox& box, LatticePoint origin) {
    for (int corner = 0; corner < 4; ++corner) {
        const int64_t u = (corner & 1) != 0 ? box.length : 0;
        const int64_t v = (corner & 2) != 0 ? box.width : 0;
        // One unit of slack covers the truncation of Q2.30 products, the corner itself is exact.
        const int64_t slack = corner == 0 ? 0 : 1;
        const int64_t x = origin.x + ((u * box.ux - v * box.uz) >> 30);
        const int64_t z = origin.z + ((u * box.uz + v * box.ux) >> 30);
        r.min = {std::min(r.min.x, x - slack), std::min(r.min.z, z - slack)};
        r.max = {std::max(r.max.x, x + slack), std::max(r.max.z, z + slack)};
    }
}

/// Largest gain of a train, by land and irregular heights.
double gain_bound(const WaveTrainBox& box) {
    return (static_cast<double>(box.gain_max) / 32768.0) *
           (1.0 + static_cast<double>(box.irregular.share) / 32768.0);
}

LatticeRect inside(const LatticeRect& r) {
    return {{std::max(r.min.x, -world_bound), std::max(r.min.z, -world_bound)},
            {std::min(r.max.x, world_bound), std::min(r.max.z, world_bound)}};
}

}  // namespace

LatticeRect bounds_of(const WaveTrainBox& box) {
    if (box.course.empty()) return bounds_over(box, box.begin, box.begin);
    const CourseLeg& last = box.course.back();
    return bounds_over(box, box.course.front().from, last.from + last.duration_us);
}

LatticeRect bounds_over(const WaveTrainBox& box, SeaTime from, SeaTime until) {
    if (box.length == 0 || box.width == 0) return {{-world_bound, -world_bound}, {world_bound, world_bound}};
    const LatticePoint first = instant_of(box, from).origin;
    LatticeRect r{first, first};
    add_box_at(r, box, first);
    if (!box.course.empty()) {
        add_box_at(r, box, corner_at(box.course, until));
        // Legs are straight, so their ends are the extremes; a leg may begin elsewhere than the one before came to.
        for (size_t i = 0; i < box.course.size(); ++i) {
            const CourseLeg& leg = box.course[i];
            if (leg.from > from && leg.from <= until) {
                add_box_at(r, box, leg.origin);
                if (i > 0) add_box_at(r, box, corner_at(std::span(box.course).first(i), leg.from));
            }
        }
        for (size_t i = 0; i < box.course.size(); ++i) {
            const SeaTime end = box.course[i].from + box.course[i].duration_us;
            if (end > from && end <= until) add_box_at(r, box, corner_at(box.course, end));
        }
    }
    return inside(r);
}

double height_bound(const WaveTrainBox& box) {
    double sum = 0.0;
    for (const WaveTrain& train : box.trains) sum += static_cast<double>(train.amplitude);
    // One part in 10^4 covers every rounding of the float32 sum of at most 256 trains.
    return (sum * gain_bound(box) + wake_bound(box.wake) + noise_bound(box.noise)) * 1.0001;
}

double displacement_bound(const WaveTrainBox& box) {
    double sum = 0.0;
    for (const WaveTrain& train : box.trains)
        sum += static_cast<double>(train.amplitude) * static_cast<double>(train.choppiness);
    return (sum * gain_bound(box) + wake_bound(box.wake) * static_cast<double>(box.wake.choppiness)) * 1.0001;
}

}  // namespace trochoid
