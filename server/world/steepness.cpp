#include "server/world/steepness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <vector>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/event/wind_limits.hpp"
#include "server/world/dispersion.hpp"

namespace trochoid {

namespace {

/// A rectangle as unit axes and half extents, metres; an unlimited side has a half extent beyond the world.
struct Rectangle {
    double ux = 1.0, uz = 0.0;
    double half_u = 0.0, half_v = 0.0;
};

constexpr double unlimited = 1e9;
/// Covers all rounding, metres.
constexpr double margin = 1.0;

struct Vector {
    double x = 0.0, z = 0.0;
};

/// A box as it moves.
struct Mover {
    Rectangle shape;
    Vector to_middle;                   // from the corner u = v = 0, metres
    LatticePoint corner;                // where it lies still
    std::span<const CourseLeg> course;  // empty: it does

    Vector centre_at(SeaTime t) const {
        const LatticePoint from = course.empty() ? corner : corner_at(course, t);
        return {to_metres(from.x) + to_middle.x, to_metres(from.z) + to_middle.z};
    }
};

Mover mover_of(const WaveTrainBox& box) {
    Mover m;
    Rectangle& r = m.shape;
    r.ux = static_cast<double>(box.ux) * 0x1p-30;
    r.uz = static_cast<double>(box.uz) * 0x1p-30;
    r.half_u = box.length == 0 ? unlimited : to_metres(box.length) / 2.0;
    r.half_v = box.width == 0 ? unlimited : to_metres(box.width) / 2.0;
    const double u = box.length == 0 ? 0.0 : r.half_u;
    const double v = box.width == 0 ? 0.0 : r.half_v;
    m.to_middle = {u * r.ux - v * r.uz, u * r.uz + v * r.ux};
    m.corner = box.origin;
    m.course = box.course;
    return m;
}

/// All that the box can reach from where it is at `from`, however it is steered until then.
Mover reach_of(const WaveTrainBox& box, SeaTime from, SeaTime until) {
    Mover m = mover_of(box);
    if (!steerable(box)) return m;
    // A part in a thousand more for the rounding of courses.
    const double metres =
        1.001 * static_cast<double>(fastest_storm) * 1e-6 * static_cast<double>(until - from);
    m.corner = corner_at(box.course, from);
    m.course = {};
    m.shape.half_u += metres;
    m.shape.half_v += metres;
    return m;
}

/// Whether the axis (ax, az) parts the rectangles while b's centre goes evenly from a's by `first` to `last`.
bool parted_along(double ax, double az, const Rectangle& a, const Rectangle& b, Vector first, Vector last) {
    const auto reach = [&](const Rectangle& r) {
        return r.half_u * std::abs(r.ux * ax + r.uz * az) + r.half_v * std::abs(r.ux * az - r.uz * ax);
    };
    const double apart = reach(a) + reach(b) + margin;
    const double from = first.x * ax + first.z * az;
    const double to = last.x * ax + last.z * az;
    return std::min(from, to) > apart || std::max(from, to) < -apart;
}

/// A rectangle and one that moves past it evenly, as two convex sets: b's way makes it a hexagon.
bool meet(const Rectangle& a, const Rectangle& b, Vector first, Vector last) {
    for (const Rectangle& r : {a, b})
        if (parted_along(r.ux, r.uz, a, b, first, last) || parted_along(-r.uz, r.ux, a, b, first, last))
            return false;
    const Vector way{last.x - first.x, last.z - first.z};
    const double length = std::sqrt(way.x * way.x + way.z * way.z);
    return length == 0.0 || !parted_along(-way.z / length, way.x / length, a, b, first, last);
}

/// Moments within (from, until) at which one of the boxes changes its velocity, with both ends, ascending.
std::vector<SeaTime> turning_points(const Mover& a, const Mover& b, SeaTime from, SeaTime until) {
    std::vector<SeaTime> times{from, until};
    for (const Mover* box : {&a, &b})
        for (const CourseLeg& leg : box->course)
            for (const SeaTime t : {leg.from, leg.from + leg.duration_us})
                if (from < t && t < until) times.push_back(t);
    std::sort(times.begin(), times.end());
    return times;
}

/// Whether they touch within [from, until).
bool meet_between(const Mover& a, const Mover& b, SeaTime from, SeaTime until) {
    const auto apart = [&](SeaTime t) {
        const Vector ca = a.centre_at(t);
        const Vector cb = b.centre_at(t);
        return Vector{cb.x - ca.x, cb.z - ca.z};
    };
    if (a.course.empty() && b.course.empty()) return meet(a.shape, b.shape, apart(from), apart(from));
    const std::vector<SeaTime> times = turning_points(a, b, from, until);
    // The last microsecond before a turn: the next leg may begin elsewhere.
    for (size_t i = 0; i + 1 < times.size(); ++i)
        if (times[i] < times[i + 1] && meet(a.shape, b.shape, apart(times[i]), apart(times[i + 1] - 1)))
            return true;
    return false;
}

/// Largest |k'| over |k| of round waves (round_wave.hpp): at the box's sides the phase leans by `share` k across.
double round_growth(const WaveTrainBox& box, const WaveTrain& train, double wave_number) {
    if (box.roundness == 0) return 1.0;
    const double share = static_cast<double>(box.roundness) / static_cast<double>(full_roundness);
    const double turns = wave_number / (2.0 * pi * static_cast<double>(lattice_per_metre));
    const double across = (static_cast<double>(train.kz) * static_cast<double>(box.ux) -
                           static_cast<double>(train.kx) * static_cast<double>(box.uz)) *
                          0x1p-62 / turns;
    return std::sqrt(1.0 + share * share + 2.0 * share * std::min(std::abs(across), 1.0));
}

/// Largest gain times |k| of a wave system of the wake's table, k0 = 1.
double steepest_node(const std::array<WakeNode, wake_cells + 1>& nodes) {
    double most = 0.0;
    for (size_t i = 0; i + 1 < nodes.size(); ++i) {
        const double gain = std::max(nodes[i].gain, nodes[i + 1].gain) * 0x1p-24;
        const double slope = (nodes[i + 1].phase - nodes[i].phase) * 0x1p-24 * 2048.0;
        for (const size_t end : {i, i + 1}) {
            const double tau = static_cast<double>(end) / 2048.0;
            const double along = nodes[end].phase * 0x1p-24 - tau * slope;
            most = std::max(most, gain * std::sqrt(along * along + slope * slope));
        }
    }
    return most;
}

double steepness_of(const ShipWake& wake) {
    if (!has_wake(wake)) return 0.0;
    static const double transverse = steepest_node(wake_table().transverse);
    static const double diverging = steepest_node(wake_table().diverging);
    // Nearer than one wavelength to the ship amplitudes rise to 3/2 of those there.
    constexpr double nearest = 1.5;
    const double k0 = 2.0 * pi * static_cast<double>(wake.inverse_length) * 0x1p-30;
    return nearest * static_cast<double>(wake.choppiness) * k0 *
           (static_cast<double>(wake.transverse) * transverse +
            static_cast<double>(wake.diverging) * diverging);
}

void limit_to(WaveTrainBox& box, double land_growth, double allowed) {
    const double asked = steepness_of(box) * land_growth;
    if (asked <= allowed) return;
    // One part in 10^6 less, so that rounding to float32 cannot lift the sum over the limit.
    const double scale = allowed / asked * 0.999999;
    for (WaveTrain& train : box.trains)
        train.choppiness = static_cast<float>(static_cast<double>(train.choppiness) * scale);
    box.wake.choppiness = static_cast<float>(static_cast<double>(box.wake.choppiness) * scale);
}

}  // namespace

bool steerable(const WaveTrainBox& box) { return !box.course.empty() && !has_wake(box.wake); }

bool may_overlap(const WaveTrainBox& a, const WaveTrainBox& b, SeaTime settled) {
    const SeaTime from = std::max(a.begin, b.begin);
    const SeaTime until = std::min(a.end + a.decay_us, b.end + b.decay_us);
    if (!(from < until)) return false;
    const bool free = steerable(a) || steerable(b);
    const SeaTime known = free ? std::clamp(settled, from, until) : until;
    if (from < known && meet_between(mover_of(a), mover_of(b), from, known)) return true;
    // A box that began before the other may have been steered before they are both there.
    const auto loose = [&](const WaveTrainBox& box) {
        return reach_of(box, std::min(std::max(settled, box.begin), known), until);
    };
    return known < until && meet_between(loose(a), loose(b), known, until);
}

double steepness_of(const WaveTrainBox& box) {
    double sum = 0.0;
    for (const WaveTrain& train : box.trains) {
        const double k = wave_number_of({train.kx, train.kz});
        sum += static_cast<double>(train.choppiness) * k * round_growth(box, train, k) *
               static_cast<double>(train.amplitude);
    }
    sum += steepness_of(box.wake);
    return sum * (1.0 + static_cast<double>(box.irregular.share) / static_cast<double>(full_irregularity));
}

SteepCrowd::SteepCrowd(std::span<const SteepBox> boxes, SeaTime settled) : settled_(settled) {
    std::map<BoxId, size_t> place;
    for (size_t i = 0; i < boxes.size(); ++i) place.emplace(boxes[i].box->id, i);
    members_.reserve(boxes.size());
    for (const SteepBox& next : boxes) {
        const auto before = next.predecessor.value == 0 ? place.end() : place.find(next.predecessor);
        members_.push_back({next.box, steepness_of(*next.box) * next.land_growth,
                            before == place.end() ? members_.size() : before->second});
    }
}

double SteepCrowd::left_to(const WaveTrainBox& box, BoxId predecessor) const {
    std::vector<uint8_t> counts(members_.size());
    for (size_t i = 0; i < members_.size(); ++i) {
        const WaveTrainBox& other = *members_[i].box;
        counts[i] =
            other.id != box.id && other.id != predecessor && may_overlap(box, other, settled_) ? 1 : 0;
    }
    double left = steepness_limit;
    for (size_t i = 0; i < members_.size(); ++i) {
        if (counts[i] == 0) continue;
        const Member& other = members_[i];
        left -= other.steepness;
        if (other.predecessor != i && counts[other.predecessor] != 0)
            left += std::min(members_[other.predecessor].steepness, other.steepness);
    }
    return std::max(left, 0.0);
}

void limit_steepness(WaveTrainBox& box, double land_growth, const SteepCrowd& crowd) {
    limit_to(box, land_growth, crowd.left_to(box) * steepness_share);
}

void limit_successor(WaveTrainBox& box, BoxId predecessor, double land_growth, const SteepCrowd& crowd) {
    limit_to(box, land_growth, crowd.left_to(box, predecessor));
}

}  // namespace trochoid
