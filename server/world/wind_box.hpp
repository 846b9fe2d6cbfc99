#pragma once
#include <cstdint>

#include "protocol/codec/messages.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "protocol/units/ids.hpp"
#include "server/event/scene.hpp"

namespace trochoid {

/// The ids that a new box takes.
struct NewIds {
    BoxId box;
    TrainId first_train;
};

/// Whether a wind's figures lie in their ranges (server/event/wind_limits.hpp) and its box inside the world.
Result<Done> validate(const StartWind& wind);

/// The box that a wind creates, builds up, sustains and ends (rows A2, A4); the wind must be valid, its seed chosen.
///
/// - u is the heading, the origin the middle of the rear edge, corner = origin - v·width/2.
/// - Trains: wind_trains. "Dominant" below is the peak of the wind's spectrum, at its reference depth.
/// - Ramps: 4 dominant wavelengths, at most 15 % of the side they stand on, at least 1 m.
/// - The leading edge runs ahead at the dominant group speed; behind it heights grow over the time in which the
///   waves cross the fetch, at most 100 dominant periods: the crossing itself is what takes long.
/// - Full until begin + life (for ever where life is 0), then all heights fall over the same span, at least 10 s.
/// - A moving wind's course is even_course over life and decay: after 4.4 years, or at the world's edge, it lies still.
/// - Roundness as asked; irregular heights and capillary noise by box_effects.hpp.
/// - The choppiness is 1 everywhere: limit_steepness comes after.
WaveTrainBox box_of(const StartWind& wind, SeaTime begin, NewIds ids);

/// The box of a hand-written record (rows A1, A4): ω from each train's quantised k; trains sorted by falling wavelength.
Result<WaveTrainBox> box_of(const SceneBox& scene, NewIds ids);

/// The wind that the log carries with a hand-written box: its place, heading and life, and the fully developed wind of its
/// significant height.
StartWind equivalent_wind(const SceneBox& scene);

}  // namespace trochoid
