#include "protocol/model/wave_train_box.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/model/gain.hpp"

namespace trochoid {

namespace {

/// A factor of the envelope with its slope per metre along its own axis.
struct RampSide {
    uint32_t gain = full_gain;
    float slope = 0.0F;
};

RampSide ramp_side(int64_t distance, int32_t length, float sign) {
    RampSide side{ramp_gain(distance, length), 0.0F};
    if (distance > 0 && distance < length) side.slope = sign * (1024.0F / static_cast<float>(length));
    return side;
}

float unit(uint32_t gain) { return static_cast<float>(gain) * 0x1p-24F; }

uint32_t time_ramp(int64_t elapsed_us, int64_t duration_us) {
    if (elapsed_us < 0) return 0;
    if (elapsed_us >= duration_us) return full_gain;
    // At most 2^39 us (6 days) by validation, so the product stays below 2^63.
    return static_cast<uint32_t>((elapsed_us << 24) / duration_us);
}

/// How far the wake's pattern falls behind the ship in a time, lattice units, below 2^31.
int64_t fallen_behind(const ShipWake& wake, int64_t elapsed_us) {
    constexpr int64_t far_behind = INT32_MAX;
    if (elapsed_us <= 0) return 0;
    // The elapsed time bounds the product below 2^56.
    if (elapsed_us >= (far_behind << 24) / wake.group_speed) return far_behind;
    return (elapsed_us * wake.group_speed) >> 24;
}

Result<Done> range_error(const char* field, const char* range) {
    return Error{ErrorCode::value_out_of_range, fmt::format("wave train box: {} is not {}", field, range)};
}

}  // namespace

BoxInstant instant_of(const WaveTrainBox& box, SeaTime t) {
    BoxInstant instant;
    instant.origin = box.course.empty() ? box.origin : corner_at(box.course, t);
    const int64_t age = t - box.begin;
    if (age < 0) return instant;
    const int64_t grown = age + box.raised_us;
    const int64_t since_end = t - box.end;
    instant.time_gain = times(time_ramp(grown, box.build_up_us), time_ramp(age, box.fade_us));
    if (since_end >= 0)
        instant.time_gain = since_end >= box.decay_us
                                ? 0
                                : times(instant.time_gain, full_gain - time_ramp(since_end, box.decay_us));
    instant.front = box.length;
    if (box.front_speed != 0 && box.length != 0) {
        // The age at which the front arrives bounds the product below 2^56.
        const int64_t arrival = (box.length << 24) / box.front_speed;
        if (grown < arrival) instant.front = std::min(box.length, (grown * box.front_speed) >> 24);
    }
    if (has_wake(box.wake)) {
        instant.wake_rear = fallen_behind(box.wake, grown);
        instant.wake_front = fallen_behind(box.wake, since_end);
    }
    return instant;
}

BoxPosition box_position(const WaveTrainBox& box, const BoxInstant& instant, LatticePoint p) {
    constexpr int64_t reach = int64_t{1} << 31;
    const int64_t dx = p.x - instant.origin.x;
    const int64_t dz = p.z - instant.origin.z;
    if (dx > reach || dx < -reach || dz > reach || dz < -reach) return {};
    // v = (-uz, ux)
    return {(dx * box.ux + dz * box.uz) >> 30, (dz * box.ux - dx * box.uz) >> 30, true};
}

Envelope envelope_at(const WaveTrainBox& box, const BoxInstant& instant, LatticePoint p) {
    Envelope e;
    if (instant.time_gain == 0) return e;
    const bool limited = box.length != 0 || box.width != 0;
    if (!limited) {
        e.gain = instant.time_gain;
        return e;
    }
    const BoxPosition at = box_position(box, instant, p);
    if (!at.in_reach) return e;
    RampSide rear;
    RampSide front;
    RampSide left;
    RampSide right;
    if (box.length != 0) {
        rear = ramp_side(at.u, box.ramp_rear, 1.0F);
        front = ramp_side(instant.front - at.u, box.ramp_front, -1.0F);
    }
    if (box.width != 0) {
        left = ramp_side(at.v, box.ramp_side, 1.0F);
        right = ramp_side(box.width - at.v, box.ramp_side, -1.0F);
    }
    const uint32_t along = times(rear.gain, front.gain);
    const uint32_t across = times(left.gain, right.gain);
    const uint32_t place = times(along, across);
    e.gain = times(place, instant.time_gain);
    if (e.gain == 0) return Envelope{};
    const float dg_du = (rear.slope * unit(front.gain) + unit(rear.gain) * front.slope) * unit(across) *
                        unit(instant.time_gain);
    const float dg_dv = (left.slope * unit(right.gain) + unit(left.gain) * right.slope) * unit(along) *
                        unit(instant.time_gain);
    const float ux = static_cast<float>(box.ux) * 0x1p-30F;
    const float uz = static_cast<float>(box.uz) * 0x1p-30F;
    e.dg_dx = dg_du * ux - dg_dv * uz;
    e.dg_dz = dg_du * uz + dg_dv * ux;
    return e;
}

LatticePoint ship_place(const WaveTrainBox& box, SeaTime t) {
    const LatticePoint corner = box.course.empty() ? box.origin : corner_at(box.course, t);
    const int64_t u = has_wake(box.wake) ? box.length : box.length / 2;
    const int64_t v = box.width / 2;
    return {corner.x + ((u * box.ux) >> 30) - ((v * box.uz) >> 30),
            corner.z + ((u * box.uz) >> 30) + ((v * box.ux) >> 30)};
}

bool alive(const WaveTrainBox& box, SeaTime from, SeaTime until) {
    return box.begin < until && from < box.end + box.decay_us;
}

namespace {

Result<Done> validate_features(const WaveTrainBox& box) {
    if (box.trains.empty() && box.noise.amplitude == 0.0F && !has_wake(box.wake))
        return range_error("the number of trains", "above 0 (only noise or a wake need none)");
    if (box.roundness > full_roundness) return range_error("the roundness", "0 to 2^15 (1)");
    if (box.roundness != 0 && box.width < shortest_ramp)
        return range_error("the width", "limited and at least 1 m, as round waves need");
    if (box.roundness != 0)
        for (const WaveTrain& train : box.trains)
            if (whole_wave_number(train.kx, train.kz) >= largest_round_wave_number)
                return range_error("a train", "at least 0.125 m long, as round waves need");
    for (size_t i = 0; i < box.overlays.size(); ++i) {
        const FieldOverlay& o = box.overlays[i];
        if (o.base.value == 0 || o.base >= o.field)
            return range_error("an overlay's base", "1 to below its field");
        if (i > 0 && o.field <= box.overlays[i - 1].field)
            return range_error("the overlays", "ascending by field");
    }
    if (auto ok = validate(std::span<const CourseLeg>(box.course)); !ok) return ok;
    if (!box.course.empty() && box.course.front().origin != box.origin)
        return range_error("the origin", "that of the first leg");
    if (auto ok = validate(box.irregular); !ok) return ok;
    if (auto ok = validate(box.noise); !ok) return ok;
    if (auto ok = validate(box.wake); !ok) return ok;
    if (has_wake(box.wake) && (box.length == 0 || box.width == 0 || box.course.size() != 1))
        return range_error("a wake's box", "limited on all sides with one leg");
    if (auto ok = validate(box.hull); !ok) return ok;
    if (has_hull(box.hull) && (box.length == 0 || box.width == 0))
        return range_error("a hull's box", "limited on all sides");
    return Done{};
}

}  // namespace

Result<Done> validate(const WaveTrainBox& box) {
    constexpr int64_t longest_ramp_us = int64_t{1} << 39;
    if (box.id.value == 0 || box.first_train.value == 0) return range_error("an id", "above 0");
    if (!inside_world(box.origin))
        return range_error("the origin", "inside the world (|x|, |z| <= 2^35 lattice units)");
    const int64_t norm = int64_t{box.ux} * box.ux + int64_t{box.uz} * box.uz;
    constexpr int64_t one = int64_t{1} << 60;
    if (norm > one + (one >> 20) || norm < one - (one >> 20))
        return range_error("the direction u", "a unit vector in Q2.30");
    for (const int64_t side : {box.length, box.width})
        if (side < 0 || side > longest_side)
            return range_error("a side", "0 (unlimited) to 2^30 lattice units");
    for (const int32_t ramp : {box.ramp_rear, box.ramp_front, box.ramp_side})
        if (ramp < shortest_ramp || ramp > longest_side) return range_error("a ramp", "1 m to 1048 km");
    for (const int64_t t : {box.begin.us, box.end.us})
        if (t < -sea_time_bound || t > sea_time_bound) return range_error("a time", "within 2^61 us");
    if (box.end < box.begin) return range_error("the end", "after the beginning");
    for (const int64_t us : {box.build_up_us, box.fade_us, box.decay_us})
        if (us < 0 || us > longest_ramp_us)
            return range_error("build-up, fade or decay", "0 to 2^39 us (6 days)");
    if (box.raised_us < 0 || box.raised_us > sea_time_bound) return range_error("raised", "0 to 2^61 us");
    if (box.trains.size() > 256) return range_error("the number of trains", "at most 256");
    if (box.first_train.value > UINT32_MAX - 256)
        return range_error("the first train's id", "below 2^32 - 256");
    for (const WaveTrain& train : box.trains)
        if (auto ok = validate(train); !ok) return ok;
    return validate_features(box);
}

}  // namespace trochoid
