#pragma once
#include <cstdint>

#include "protocol/units/ids.hpp"
#include "protocol/units/result.hpp"

namespace trochoid {

/// One Gerstner wave train as quantised once by the server; the quantised wave is the truth. 28 bytes travel (the
/// field's id travels as an index of the box). k, omega and phase of a live train never change.
struct WaveTrain {
    /// Wave vector in turns per lattice unit, Q0.32, pointing where the waves travel (x east, z south).
    int32_t kx = 0;
    int32_t kz = 0;
    /// Angular frequency in turns per microsecond, Q0.64.
    uint64_t omega = 0;
    /// Phase at x = z = 0 and sea time 0, turns Q0.32.
    uint32_t phase = 0;
    /// Amplitude in metres: 0, or 2^-20 to 32.
    float amplitude = 0.0F;
    /// Choppiness: horizontal over vertical orbit, 0 to 4 (1 is Gerstner's circle).
    float choppiness = 0.0F;
    /// The land field that shifts and scales this train; none over open water.
    FieldId field;
    bool operator==(const WaveTrain&) const = default;
};

/// What the sum needs of a train, derived on the CPU in a written order of float32 + - * / sqrt (model: "Sum over trains").
struct TrainConstants {
    float k = 0.0F;           ///< wave number, rad/m
    float dx = 0.0F;          ///< unit direction of travel, east
    float dz = 0.0F;          ///< unit direction of travel, south
    float kx = 0.0F;          ///< k * dx, rad/m
    float kz = 0.0F;          ///< k * dz, rad/m
    float a = 0.0F;           ///< amplitude, m
    float hx = 0.0F;          ///< (choppiness * amplitude) * dx, m
    float hz = 0.0F;          ///< (choppiness * amplitude) * dz, m
    float wavelength = 0.0F;  ///< 2*pi / k in metres, by division in turns: 1 / n
    float omega = 0.0F;       ///< rad/s, for particle velocities only
    uint32_t whole = 0;       ///< whole_wave_number: turns per lattice unit, Q0.32, for round waves
    bool operator==(const TrainConstants&) const = default;
};

TrainConstants derive_constants(const WaveTrain& train);

/// Phase of the train at the origin at a sea time: phase - omega * T, turns Q0.32, wrapping.
constexpr uint32_t phase_at_origin(const WaveTrain& train, int64_t sea_time_us) {
    return train.phase - static_cast<uint32_t>((train.omega * static_cast<uint64_t>(sea_time_us)) >> 32);
}

/// Part of the phase that comes from place: kx*X + kz*Z mod 1 turn, from the low 32 bits of the position.
constexpr uint32_t phase_from_place(const WaveTrain& train, int64_t x, int64_t z) {
    return static_cast<uint32_t>(train.kx) * static_cast<uint32_t>(static_cast<uint64_t>(x)) +
           static_cast<uint32_t>(train.kz) * static_cast<uint32_t>(static_cast<uint64_t>(z));
}

/// Whether a train from elsewhere may enter the sea: finite, k not 0, amplitude and choppiness in range.
Result<Done> validate(const WaveTrain& train);

}  // namespace trochoid
