#include "server/interest/box_footprint.hpp"

#include <algorithm>
#include <span>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

/// Covers the truncation of Q2.30 products and a direction that is a unit vector to 2^-20 only.
constexpr double footprint_margin = 1.0;      // m
constexpr double footprint_stretch = 2.0e-6;  // of the sides
/// The wake's table ends at tau = 3/8.
constexpr int64_t widest_wake_eighths = 3;

double magnitude(double v) { return v < 0.0 ? -v : v; }

/// Sixteenths of `whole` that `part` has begun, 0 to 16. Both below 2^40.
int64_t sixteenths(int64_t part, int64_t whole) {
    if (part <= 0) return 0;
    if (part >= whole) return 16;
    return (part * 16 + whole - 1) / whole;
}

/// A closed interval, lattice units.
struct Reach {
    int64_t least = 0;
    int64_t most = 0;
    void take(int64_t v) {
        least = std::min(least, v);
        most = std::max(most, v);
    }
};

/// How far along its own axes the box's corner strays from where it is at `from`.
struct Drift {
    Reach u;
    Reach v;
};

Drift drift_over(const WaveTrainBox& record, LatticePoint start, SeaTime from, SeaTime until) {
    Drift drift;
    const auto take = [&](LatticePoint p) {
        const double dx = to_metres(p.x - start.x), dz = to_metres(p.z - start.z);
        const double ux = static_cast<double>(record.ux) / static_cast<double>(1 << 30);
        const double uz = static_cast<double>(record.uz) / static_cast<double>(1 << 30);
        drift.u.take(to_lattice(dx * ux + dz * uz));
        drift.v.take(to_lattice(dz * ux - dx * uz));
    };
    // Evenly along a leg, so its ends bound it; the end of one leg may lie elsewhere than the beginning of the next.
    const std::span<const CourseLeg> legs(record.course);
    for (size_t i = 0; i < legs.size(); ++i) {
        if (legs[i].from <= from) continue;
        if (legs[i].from > until) break;
        take(legs[i].origin);
        if (i > 0) take(corner_at(legs.first(i), legs[i].from));
    }
    if (!legs.empty()) take(corner_at(legs, until));
    return drift;
}

/// What of the box there is to lay out, lattice units along its axes.
struct Extent {
    Reach u;
    Reach v;
};

/// A ship's wake stands between two distances behind the ship, and its wedge reaches aside by tau at most.
void narrow_to_wake(Extent& extent, const WaveTrainBox& record, int64_t nearest, int64_t farthest) {
    extent.u = {std::max(record.length - farthest, extent.u.least),
                std::min(record.length - nearest, extent.u.most)};
    extent.u.most = std::max(extent.u.least, extent.u.most);
    const int64_t aside = farthest * widest_wake_eighths / 8 + lattice_per_metre;
    extent.v = {std::max(record.width / 2 - aside, extent.v.least),
                std::min(record.width / 2 + aside, extent.v.most)};
}

/// A ship's bow reaches beyond the front edge of her wake.
void widen_to_hull(Extent& extent, const WaveTrainBox& record) {
    const int64_t amidships = has_wake(record.wake) ? record.length : record.length / 2;
    const int64_t half = to_lattice(static_cast<double>(record.hull.length) * 0.5);
    const int64_t aside = to_lattice(static_cast<double>(record.hull.beam) * 0.5);
    extent.u.take(amidships - half);
    extent.u.take(amidships + half);
    extent.v.take(record.width / 2 - aside);
    extent.v.take(record.width / 2 + aside);
}

void lay_out(BoxFootprint& f, LatticePoint anchor, SeaTime from, SeaTime until, const Extent& extent) {
    const WaveTrainBox& record = f.box->sea->record;
    const LatticePoint start = record.course.empty() ? record.origin : corner_at(record.course, from);
    const Drift drift = drift_over(record, start, from, until);
    f.ux = static_cast<double>(record.ux) / static_cast<double>(1 << 30);
    f.uz = static_cast<double>(record.uz) / static_cast<double>(1 << 30);
    f.limited_length = record.length != 0;
    f.limited_width = record.width != 0;
    f.x = to_metres(start.x - anchor.x);
    f.z = to_metres(start.z - anchor.z);
    f.least_u = to_metres(drift.u.least + extent.u.least);
    f.least_v = to_metres(drift.v.least + extent.v.least);
    f.length = to_metres(drift.u.most - drift.u.least + extent.u.most - extent.u.least);
    f.width = to_metres(drift.v.most - drift.v.least + extent.v.most - extent.v.least);
    // v = (-uz, ux)
    const double margin =
        footprint_margin +
        (f.length + f.width + magnitude(f.least_u) + magnitude(f.least_v)) * footprint_stretch;
    const double x = f.x + f.least_u * f.ux - f.least_v * f.uz;
    const double z = f.z + f.least_u * f.uz + f.least_v * f.ux;
    const double along_x = f.length * f.ux, along_z = f.length * f.uz;
    const double across_x = -f.width * f.uz, across_z = f.width * f.ux;
    f.min_x = x + std::min(along_x, 0.0) + std::min(across_x, 0.0) - margin;
    f.max_x = x + std::max(along_x, 0.0) + std::max(across_x, 0.0) + margin;
    f.min_z = z + std::min(along_z, 0.0) + std::min(across_z, 0.0) - margin;
    f.max_z = z + std::max(along_z, 0.0) + std::max(across_z, 0.0) + margin;
}

}  // namespace

SquareOnSea square_on_sea(const LatticeRect& square, LatticePoint anchor, double reach) {
    const double side = to_metres(square.max.x - square.min.x);
    return {to_metres(square.min.x - anchor.x) + side * 0.5, to_metres(square.min.z - anchor.z) + side * 0.5,
            side * 0.5 + reach};
}

double largest_share(const WaveTrainBox& box, SeaTime from, SeaTime until) {
    const int64_t age = until - box.begin;
    const int64_t grown = sixteenths(age + box.raised_us, box.build_up_us);
    const int64_t taken_over = sixteenths(age, box.fade_us);
    const int64_t left = from < box.end ? 16 : sixteenths(box.decay_us - (from - box.end), box.decay_us);
    // The product of the ramps' largest is above the largest product.
    const int64_t share = (grown * taken_over * left + 255) / 256;
    return static_cast<double>(share) / 16.0;
}

BoxFootprint footprint_over(const IndexedBox& box, LatticePoint anchor, SeaTime from, SeaTime until) {
    BoxFootprint f;
    f.box = &box;
    const WaveTrainBox& record = box.sea->record;
    if (!alive(record, from, until)) return f;
    f.share = largest_share(record, from, until);
    f.height = box.height * f.share;
    f.displacement = box.displacement * f.share;
    // Front and wake only go on, but where the box has died by then they say nothing.
    const SeaTime last = std::min(until, record.end + std::max<int64_t>(record.decay_us - 1, 0));
    const BoxInstant late = instant_of(record, last);
    Extent extent{{0, late.time_gain != 0 ? late.front : record.length}, {0, record.width}};
    if (has_wake(record.wake) && record.trains.empty() && record.noise.amplitude == 0.0F &&
        late.time_gain != 0)
        narrow_to_wake(extent, record, instant_of(record, from).wake_front, late.wake_rear);
    if (has_hull(record.hull) && from < record.end) widen_to_hull(extent, record);
    lay_out(f, anchor, from, until, extent);
    return f;
}

BoxFootprint whole_footprint(const IndexedBox& box, LatticePoint anchor, SeaTime from) {
    BoxFootprint f;
    f.box = &box;
    f.share = 1.0;
    const WaveTrainBox& record = box.sea->record;
    lay_out(f, anchor, from, end_of_time, {{0, record.length}, {0, record.width}});
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
        const double u = dx * f.ux + dz * f.uz - f.least_u;
        if (u + reach < 0.0 || u - reach > f.length) return false;
    }
    if (f.limited_width) {
        const double v = dz * f.ux - dx * f.uz - f.least_v;
        if (v + reach < 0.0 || v - reach > f.width) return false;
    }
    return true;
}

}  // namespace trochoid
