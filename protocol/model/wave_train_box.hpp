#pragma once
#include <cstdint>
#include <vector>

#include "protocol/model/box_course.hpp"
#include "protocol/model/hull.hpp"
#include "protocol/model/irregular_height.hpp"
#include "protocol/model/round_wave.hpp"
#include "protocol/model/ship_wake.hpp"
#include "protocol/model/surface_noise.hpp"
#include "protocol/model/wave_train.hpp"
#include "protocol/units/lattice.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// 1.0 of an envelope, Q0.24.
inline constexpr uint32_t full_gain = uint32_t{1} << 24;

/// Longest side of a limited box: 2^30 lattice units, 1048 km.
inline constexpr int64_t longest_side = int64_t{1} << 30;
/// Shortest ramp: 1 m. Nothing ends abruptly.
inline constexpr int32_t shortest_ramp = 1 << 10;

/// A land field that lies over another: where it has no block, its base's counts (land that changes while the sea runs travels as the
/// changed blocks alone).
struct FieldOverlay {
    FieldId field;
    FieldId base;  ///< below `field`
    bool operator==(const FieldOverlay&) const = default;
};

/// An oriented wave train box (paper A, section 2; rows A1, A2, A4): where and when its trains act. All that lets it
/// grow and decay is in the record, so growth and decay cost no traffic. Records are replaced whole under the same id
/// (a stopped wind brings t_end forward), and a replacement never changes the sea before its effective time.
struct WaveTrainBox {
    BoxId id;
    /// The trains carry the ids first_train, first_train + 1, …, by falling wavelength, so a filter keeps a prefix.
    TrainId first_train;
    /// The corner u = v = 0: rear left, looking along the direction of travel.
    LatticePoint origin;
    /// Direction of travel u, Q2.30 (x east, z south). v = (-uz, ux) points to the right.
    int32_t ux = 1 << 30;
    int32_t uz = 0;
    /// Fetch (along u) and width (along v) in lattice units, up to 2^30; 0 is unlimited and has no ramp.
    int64_t length = 0;
    int64_t width = 0;
    /// Lengths of the linear ramps at the rear (u = 0), the front (u = length) and both sides, lattice units >= 1 m.
    int32_t ramp_rear = shortest_ramp;
    int32_t ramp_front = shortest_ramp;
    int32_t ramp_side = shortest_ramp;
    /// Still before begin; then the product of three linear ramps in time: over build_up from begin - raised, over fade from begin,
    /// and down over decay from end. raised and fade are 0 but for the successor of a box whose land has changed: it takes over at
    /// `begin` within `fade`, as far grown (its front too) as the wind that rose `raised` before.
    SeaTime begin;
    int64_t raised_us = 0;  ///< 0 to 2^61
    int64_t fade_us = 0;
    int64_t build_up_us = 0;
    SeaTime end = end_of_time;
    int64_t decay_us = 0;
    /// Speed of the leading edge while the wind builds, lattice units per microsecond in Q.24 (the dominant train's
    /// group speed; 1 m/s = 17180); 0 fills the whole box at once. Only for boxes with a limited length.
    uint32_t front_speed = 0;
    /// Bound of the land gain over all the box's fields, Q1.15 (32768 = 1): enters bounds of height and displacement. Orbit factors are
    /// not in it: over shallow water the two together may be above what Q1.15 holds.
    uint16_t gain_max = 1 << 15;
    /// Roundness of the crests (round_wave.hpp), Q1.15; needs a limited width.
    uint16_t roundness = 0;
    /// At most 256; a box without any has noise or a wake.
    std::vector<WaveTrain> trains;
    /// Ascending by field.
    std::vector<FieldOverlay> overlays;
    /// Empty: the box stands at `origin`; else origin is that of the first leg.
    std::vector<CourseLeg> course;
    IrregularHeight irregular;
    SurfaceNoise noise;
    ShipWake wake;
    /// Of the ship that makes the wake or, without one, of a ship that lies still. No sum and no hash reads it: programs that do not
    /// know it hold the same sea.
    Hull hull;
    bool operator==(const WaveTrainBox&) const = default;
};

/// What a box is at one instant: the time part of its envelope.
struct BoxInstant {
    uint32_t time_gain = 0;  ///< Q0.24
    int64_t front = 0;       ///< u of the leading edge, lattice units; length once grown
    LatticePoint origin;     ///< where the corner is (course)
    /// Of a wake: distances behind the ship between which its pattern stands, lattice units.
    int64_t wake_front = 0;
    int64_t wake_rear = 0;
    bool operator==(const BoxInstant&) const = default;
};
BoxInstant instant_of(const WaveTrainBox& box, SeaTime t);

/// The envelope at a point: gain Q0.24 and its gradient per metre along x and z.
struct Envelope {
    uint32_t gain = 0;
    float dg_dx = 0.0F;
    float dg_dz = 0.0F;
    bool operator==(const Envelope&) const = default;
};
Envelope envelope_at(const WaveTrainBox& box, const BoxInstant& instant, LatticePoint p);

/// Position in box axes, lattice units: u along travel, v to the right. False (out of reach) where the point is
/// farther than 2^31 units along x or z from the origin, hence outside every limited side.
struct BoxPosition {
    int64_t u = 0;
    int64_t v = 0;
    bool in_reach = false;
};
BoxPosition box_position(const WaveTrainBox& box, const BoxInstant& instant, LatticePoint p);

/// A linear ramp, Q0.24: 0 for distance <= 0, full from distance >= length. With reciprocal = 2^40 / length the value is
/// (distance * reciprocal) >> 16: one 32-by-32-bit product, the same on a GPU without 64-bit integers.
constexpr uint32_t ramp_gain(int64_t distance, int32_t length) {
    if (distance <= 0) return 0;
    if (distance >= length) return full_gain;
    const uint64_t reciprocal = (uint64_t{1} << 40) / static_cast<uint64_t>(length);
    return static_cast<uint32_t>((static_cast<uint64_t>(distance) * reciprocal) >> 16);
}

/// Bounding rectangle of everything that the box can ever touch (unlimited sides reach the world's bounds).
LatticeRect bounds_of(const WaveTrainBox& box);

/// The same for what it can touch within a span of sea time.
LatticeRect bounds_over(const WaveTrainBox& box, SeaTime from, SeaTime until);

/// Upper bound of |y| at any point and time: sum of A over the trains times gain_max times (1 + irregular share), plus the
/// wake's and the noise's bounds, metres (float64, rounded up).
double height_bound(const WaveTrainBox& box);

/// Upper bound of the horizontal displacement where no orbit factor is above 1, metres; else to be times the largest.
double displacement_bound(const WaveTrainBox& box);

/// Whether the box is a ship's: she is there from its `begin` until before its `end`, and looks along u.
inline bool is_ship(const WaveTrainBox& box) { return has_wake(box.wake) || has_hull(box.hull); }
/// Where the ship of such a box is amidships: with a wake at the middle of the front edge, without one at the middle of the box.
LatticePoint ship_place(const WaveTrainBox& box, SeaTime t);

/// Span of sea time [begin, end + decay) outside which the box is still water.
bool alive(const WaveTrainBox& box, SeaTime from, SeaTime until);

/// Whether a box from elsewhere may enter the sea: every field in range, every train valid. The error names the field.
Result<Done> validate(const WaveTrainBox& box);

}  // namespace trochoid
