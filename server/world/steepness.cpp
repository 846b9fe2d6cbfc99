#include "server/world/steepness.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/world/dispersion.hpp"

namespace trochoid {

namespace {

/// A rectangle as centre, unit axes and half extents, metres; an unlimited side has a half extent beyond the world.
struct Rectangle {
    double x = 0.0, z = 0.0;
    double ux = 1.0, uz = 0.0;
    double half_u = 0.0, half_v = 0.0;
};

constexpr double unlimited = 1e9;

Rectangle rectangle_of(const WaveTrainBox& box) {
    Rectangle r;
    r.ux = static_cast<double>(box.ux) * 0x1p-30;
    r.uz = static_cast<double>(box.uz) * 0x1p-30;
    const double u = to_metres(box.length) / 2.0;
    const double v = to_metres(box.width) / 2.0;
    r.half_u = box.length == 0 ? unlimited : u;
    r.half_v = box.width == 0 ? unlimited : v;
    r.x = to_metres(box.origin.x) + u * r.ux - v * r.uz;
    r.z = to_metres(box.origin.z) + u * r.uz + v * r.ux;
    return r;
}

/// Whether the unit axis (ax, az) parts the rectangles by more than the metre that covers all rounding.
bool parted_along(double ax, double az, const Rectangle& a, const Rectangle& b) {
    const auto reach = [&](const Rectangle& r) {
        return r.half_u * std::abs(r.ux * ax + r.uz * az) + r.half_v * std::abs(r.ux * az - r.uz * ax);
    };
    return std::abs((b.x - a.x) * ax + (b.z - a.z) * az) > reach(a) + reach(b) + 1.0;
}

}  // namespace

bool may_overlap(const WaveTrainBox& a, const WaveTrainBox& b) {
    if (!(a.begin < b.end + b.decay_us && b.begin < a.end + a.decay_us)) return false;
    const Rectangle ra = rectangle_of(a);
    const Rectangle rb = rectangle_of(b);
    for (const Rectangle& r : {ra, rb})
        if (parted_along(r.ux, r.uz, ra, rb) || parted_along(-r.uz, r.ux, ra, rb)) return false;
    return true;
}

double steepness_of(const WaveTrainBox& box) {
    double sum = 0.0;
    for (const WaveTrain& train : box.trains)
        sum += static_cast<double>(train.choppiness) * wave_number_of({train.kx, train.kz}) *
               static_cast<double>(train.amplitude);
    return sum;
}

void limit_steepness(WaveTrainBox& box, double land_growth, std::span<const SteepBox> others) {
    double left = steepness_limit;
    for (const SteepBox& other : others)
        if (other.box->id != box.id && may_overlap(box, *other.box))
            left -= steepness_of(*other.box) * other.land_growth;
    const double allowed = std::max(left, 0.0) * steepness_share;
    const double asked = steepness_of(box) * land_growth;
    if (asked <= allowed) return;
    // One part in 10^6 less, so that rounding to float32 cannot lift the sum over the limit.
    const double scale = allowed / asked * 0.999999;
    for (WaveTrain& train : box.trains)
        train.choppiness = static_cast<float>(static_cast<double>(train.choppiness) * scale);
}

}  // namespace trochoid
