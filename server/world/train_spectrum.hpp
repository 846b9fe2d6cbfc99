#pragma once
#include <cstdint>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "protocol/model/wave_train.hpp"
#include "server/world/significant_height.hpp"

namespace trochoid {

/// What a wind draws from its seed; every (stream, index) is its own number.
enum class Stream : uint64_t { frequency = 1, direction = 2, shuffle = 3, phase = 4, groups = 5, noise = 6 };
uint64_t draw(uint64_t seed, Stream stream, uint64_t index);

/// The wave trains of a valid wind with its seed chosen, by falling wavelength, choppiness 1, without land (rows A2, B1, C1):
/// `trains` trains of equal energy E/N from the wind's spectrum and spreading, so each has the amplitude ζ = √(2E/N). (Paper C's
/// eq. 4 gives √(A/(2BM)) for M shares of E(∞) = A/(4B), hence √(A/(2BMn)) for M n of them; the prefactor of its eq. 5 is
/// misprinted, and its +ωt runs waves backwards: ours run towards k.) 4 √(Σ A²/2) is the spectrum's own Hs over its used range,
/// also for one train alone.
///
/// - directions = 0: the frequencies are the medians of N strata of equal energy, each moved by up to a quarter of its stratum,
///   and every train has a direction of its own: the strata of the spreading at its frequency, dealt in an order shuffled by
///   the seed. One train alone lies at the peak and on the heading; as a regular wave it is 2A = Hs/√2 high.
/// - directions = n: paper C's partition M × n, M = N/n. Each of the M strata of frequency (drawn as above) has n directions, one
///   drawn from each of n strata of equal energy of the spreading at its frequency.
///
/// k by the full relation at reference_depth (0: deep) and quantised, then ω from the quantised k. Phases uniform. All chance is
/// splitmix64 of the seed.
std::vector<WaveTrain> wind_trains(const StartWind& wind);

/// Depth in metres that a wind's trains are for: reference_depth, deep_water for 0.
double reference_depth_of(const StartWind& wind);

}  // namespace trochoid
