#include "protocol/model/wave_train_box.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"

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

uint32_t times(uint32_t a, uint32_t b) { return static_cast<uint32_t>((static_cast<uint64_t>(a) * b) >> 24); }

float unit(uint32_t gain) { return static_cast<float>(gain) * 0x1p-24F; }

uint32_t time_ramp(int64_t elapsed_us, int64_t duration_us) {
    if (elapsed_us < 0) return 0;
    if (elapsed_us >= duration_us) return full_gain;
    // At most 2^39 us (6 days) by validation, so the product stays below 2^63.
    return static_cast<uint32_t>((elapsed_us << 24) / duration_us);
}

Result<Done> range_error(const char* field, const char* range) {
    return Error{ErrorCode::value_out_of_range, fmt::format("wave train box: {} is not {}", field, range)};
}

}  // namespace

BoxInstant instant_of(const WaveTrainBox& box, SeaTime t) {
    const int64_t age = t - box.begin;
    if (age < 0) return {};
    const int64_t since_end = t - box.end;
    BoxInstant instant;
    instant.time_gain = time_ramp(age, box.build_up_us);
    if (since_end >= 0)
        instant.time_gain = since_end >= box.decay_us
                                ? 0
                                : times(instant.time_gain, full_gain - time_ramp(since_end, box.decay_us));
    instant.front = box.length;
    if (box.front_speed != 0 && box.length != 0) {
        // The age at which the front arrives bounds the product below 2^56.
        const int64_t arrival = (box.length << 24) / box.front_speed;
        if (age < arrival) instant.front = std::min(box.length, (age * box.front_speed) >> 24);
    }
    return instant;
}

BoxPosition box_position(const WaveTrainBox& box, LatticePoint p) {
    constexpr int64_t reach = int64_t{1} << 31;
    const int64_t dx = p.x - box.origin.x;
    const int64_t dz = p.z - box.origin.z;
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
    const BoxPosition at = box_position(box, p);
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

LatticeRect bounds_of(const WaveTrainBox& box) {
    const LatticeRect world{{-world_bound, -world_bound}, {world_bound, world_bound}};
    if (box.length == 0 || box.width == 0) return world;
    LatticeRect r{box.origin, box.origin};
    for (int corner = 1; corner < 4; ++corner) {
        const int64_t u = (corner & 1) != 0 ? box.length : 0;
        const int64_t v = (corner & 2) != 0 ? box.width : 0;
        // One unit of slack covers the truncation of Q2.30 products.
        const int64_t x = box.origin.x + ((u * box.ux - v * box.uz) >> 30);
        const int64_t z = box.origin.z + ((u * box.uz + v * box.ux) >> 30);
        r.min = {std::min(r.min.x, x - 1), std::min(r.min.z, z - 1)};
        r.max = {std::max(r.max.x, x + 1), std::max(r.max.z, z + 1)};
    }
    r.min = {std::max(r.min.x, -world_bound), std::max(r.min.z, -world_bound)};
    r.max = {std::min(r.max.x, world_bound), std::min(r.max.z, world_bound)};
    return r;
}

double height_bound(const WaveTrainBox& box) {
    double sum = 0.0;
    for (const WaveTrain& train : box.trains) sum += static_cast<double>(train.amplitude);
    // One part in 10^6 covers every rounding of the float32 sum of at most 256 trains.
    return sum * (static_cast<double>(box.gain_max) / 32768.0) * 1.0001;
}

double displacement_bound(const WaveTrainBox& box) {
    double sum = 0.0;
    for (const WaveTrain& train : box.trains)
        sum += static_cast<double>(train.amplitude) * static_cast<double>(train.choppiness);
    return sum * (static_cast<double>(box.gain_max) / 32768.0) * 1.0001;
}

bool alive(const WaveTrainBox& box, SeaTime from, SeaTime until) {
    return box.begin < until && from < box.end + box.decay_us;
}

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
    for (const int64_t us : {box.build_up_us, box.decay_us})
        if (us < 0 || us > longest_ramp_us) return range_error("build-up or decay", "0 to 2^39 us (6 days)");
    if (box.trains.empty() || box.trains.size() > 256) return range_error("the number of trains", "1 to 256");
    if (box.first_train.value > UINT32_MAX - 256)
        return range_error("the first train's id", "below 2^32 - 256");
    for (const WaveTrain& train : box.trains)
        if (auto ok = validate(train); !ok) return ok;
    return Done{};
}

}  // namespace trochoid
