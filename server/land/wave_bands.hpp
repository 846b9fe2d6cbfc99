#pragma once
#include <cstddef>
#include <vector>

#include "protocol/model/wave_train_box.hpp"

namespace trochoid {

/// Trains of a box that share one land field: within one octave of wave length and 15 degrees of direction.
struct WaveBand {
    /// Unit vector of the mean direction, weighted by amplitude squared (x east, z south).
    double dx = 1.0;
    double dz = 0.0;
    /// Mean wave number, weighted alike, in turns per metre.
    double turns_per_metre = 0.0;
    /// Sum of A^2 / 2 over the band, m^2.
    double variance = 0.0;
    /// Sum of A * k, turns, and its wave number (mean weighted by A), turns per metre: what land makes steeper. Choppiness does
    /// not enter (LandSettings::steepness_max).
    double steepness = 0.0;
    double steep_turns_per_metre = 0.0;
    /// Indices into the box's trains, ascending.
    std::vector<size_t> trains;
    bool operator==(const WaveBand&) const = default;
};

/// Octaves end at powers of two of a metre; direction bins are centred on the box's u and every 15 degrees from it.
/// Bands come in the order of their first train; every train is in exactly one.
std::vector<WaveBand> wave_bands(const WaveTrainBox& box);

/// Significant height of all trains of the box, metres (server/world/significant_height.hpp).
double significant_height(const WaveTrainBox& box);

}  // namespace trochoid
