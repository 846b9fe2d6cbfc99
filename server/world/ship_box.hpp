#pragma once
#include "protocol/codec/messages.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "server/world/wind_box.hpp"

namespace trochoid {

/// How high a hull's waves are, metres.
struct ShipWaves {
    double transverse = 0.0;  ///< one wavelength behind the ship, on its course
    double diverging = 0.0;   ///< one wavelength behind, where they are strongest
    bool operator==(const ShipWaves&) const = default;
};

/// Heights of a ship's waves by a simple law of its Froude number F = V/√(g L): diverging = B/4 · min(F, 1/2)², so it grows
/// with the square of the speed and levels off where the hull begins to plane, and transverse = diverging · min(1, 1/(2F))⁴: a
/// planing hull leaves none. Neither is steeper than k0 A = 0.1 with k0 = g/V² (a broad hull). It gives 0.36 m for a hull of 100 m by
/// 14 m at 10 m/s, 0.53 m for 300 m by 43 m at 12 m/s, and 0.16 m (transverse 0.003 m) for a boat of 8 m by 2.5 m at 12 m/s; a real hull
/// differs by a factor of two either way (its lines decide, which the law does not know). speed in m/s, length and beam in metres, beam 0:
/// length/7.
ShipWaves ship_waves(double speed, double length, double beam);

/// Longest wake, metres, and the wavelengths behind the ship that it has where that is less.
inline constexpr double longest_wake = 20000.0;
inline constexpr double wavelengths_of_wake = 40.0;

/// Whether a ship's figures lie in their ranges and it begins inside the world.
Result<Done> validate(const StartShip& ship);

/// The box of one straight course of a ship (rows A12, B11), which it begins at `begin`; the ship must be valid.
///
/// - The ship is at the middle of the front edge (u = length, v = width/2) and sails along u; the box moves with it, one leg of
///   at most 25 days (or to the world's edge), after which the ship stops.
/// - λ0 = 2πV²/g, at least 0.5 m. Length 40 λ0, at most 20 km; width 3/4 of the length (the wedge of 19.47°, to the end of the
///   wake's table) and the ramps; a quarter of the length fades at the rear.
/// - It builds up over a transverse wave's period, at least 1 s; the pattern falls behind at the group speed V/2. When the course
///   ends, the box moves on without a ship while the pattern falls behind, until none of it is left: 2 length / V.
/// - Choppiness 1: limit_steepness comes after.
/// Refused where the world's edge is too near for the wake.
Result<WaveTrainBox> box_of(const StartShip& ship, SeaTime begin, NewIds ids);

/// The box of a ship that lies still from `begin` on, where that ship is then and turned as she is. It is the hull's rectangle, with one
/// train of amplitude 0, which every program reads and none sees. It lasts until she sails on or is taken out.
WaveTrainBox lying_box(const WaveTrainBox& ship, SeaTime begin, NewIds ids);

/// The hull that the log keeps in the fields of a wind; none where those say nothing of one.
Hull logged_hull(const StartWind& wind);

/// What the log keeps of the ship beside its box, in the fields of a wind: speed and heading of the course, the hull's length
/// as `fetch`, its beam as `width`, where it began as `origin`, no trains. And back (the place is `ship_place`'s).
StartWind logged_wind(const StartShip& ship);
StartShip logged_ship(const StartWind& wind);

}  // namespace trochoid
