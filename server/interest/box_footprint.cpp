#include "server/interest/box_footprint.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

/// Covers the truncation of Q2.30 products and a direction that is a unit vector to 2^-20 only.
constexpr double footprint_margin = 1.0;      // m
constexpr double footprint_stretch = 2.0e-6;  // of the sides

double magnitude(double v) { return v < 0.0 ? -v : v; }

/// Sixteenths of `whole` that `part` has begun, 0 to 16. Both below 2^40.
int64_t sixteenths(int64_t part, int64_t whole) {
    if (part <= 0) return 0;
    if (part >= whole) return 16;
    return (part * 16 + whole - 1) / whole;
}

void lay_out(BoxFootprint& f, LatticePoint anchor, int64_t front) {
    const WaveTrainBox& record = f.box->sea->record;
    f.x = to_metres(record.origin.x - anchor.x);
    f.z = to_metres(record.origin.z - anchor.z);
    f.ux = static_cast<double>(record.ux) / static_cast<double>(1 << 30);
    f.uz = static_cast<double>(record.uz) / static_cast<double>(1 << 30);
    f.limited_length = record.length != 0;
    f.limited_width = record.width != 0;
    f.length = to_metres(f.limited_length ? front : 0);
    f.width = to_metres(record.width);
    const double margin = footprint_margin + (f.length + f.width) * footprint_stretch;
    // v = (-uz, ux)
    const double along_x = f.length * f.ux, along_z = f.length * f.uz;
    const double across_x = -f.width * f.uz, across_z = f.width * f.ux;
    f.min_x = f.x + std::min(along_x, 0.0) + std::min(across_x, 0.0) - margin;
    f.max_x = f.x + std::max(along_x, 0.0) + std::max(across_x, 0.0) + margin;
    f.min_z = f.z + std::min(along_z, 0.0) + std::min(across_z, 0.0) - margin;
    f.max_z = f.z + std::max(along_z, 0.0) + std::max(across_z, 0.0) + margin;
}

}  // namespace

SquareOnSea square_on_sea(const LatticeRect& square, LatticePoint anchor, double reach) {
    const double side = to_metres(square.max.x - square.min.x);
    return {to_metres(square.min.x - anchor.x) + side * 0.5, to_metres(square.min.z - anchor.z) + side * 0.5,
            side * 0.5 + reach};
}

double largest_share(const WaveTrainBox& box, SeaTime from, SeaTime until) {
    const int64_t grown = sixteenths(until - box.begin, box.build_up_us);
    const int64_t left = from < box.end ? 16 : sixteenths(box.decay_us - (from - box.end), box.decay_us);
    // The product of the rise's and the fall's largest is above the largest product.
    return static_cast<double>((grown * left + 15) / 16) / 16.0;
}

BoxFootprint footprint_over(const IndexedBox& box, LatticePoint anchor, SeaTime from, SeaTime until) {
    BoxFootprint f;
    f.box = &box;
    const WaveTrainBox& record = box.sea->record;
    if (!alive(record, from, until)) return f;
    f.share = largest_share(record, from, until);
    f.height = height_bound(record) * f.share;
    f.displacement = displacement_bound(record) * f.share;
    lay_out(f, anchor, instant_of(record, until).front);
    return f;
}

BoxFootprint whole_footprint(const IndexedBox& box, LatticePoint anchor) {
    BoxFootprint f;
    f.box = &box;
    f.share = 1.0;
    lay_out(f, anchor, box.sea->record.length);
    return f;
}

bool touches(const BoxFootprint& f, const SquareOnSea& s) {
    if (f.limited_length && f.limited_width) {
        if (s.x + s.half < f.min_x || s.x - s.half > f.max_x) return false;
        if (s.z + s.half < f.min_z || s.z - s.half > f.max_z) return false;
    }
    const double dx = s.x - f.x;
    const double dz = s.z - f.z;
    const double reach = s.half * (magnitude(f.ux) + magnitude(f.uz)) + footprint_margin;
    if (f.limited_length) {
        const double u = dx * f.ux + dz * f.uz;
        if (u + reach < 0.0 || u - reach > f.length) return false;
    }
    if (f.limited_width) {
        const double v = dz * f.ux - dx * f.uz;
        if (v + reach < 0.0 || v - reach > f.width) return false;
    }
    return true;
}

}  // namespace trochoid
