#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/units/lattice.hpp"
#include "protocol/units/result.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// Gradient noise on the water of a box (paper A, eq. 9, capillary noise, row A8; paper D, section 4, gradient-noise displacement,
/// model side of row D5): hashed lattice gradients in (x, z, t), vertical only, times the box's envelope. Capillary noise over all
/// visible water is the noise of an unlimited box without trains, and of each wind's own box on top. amplitude 0 = none.
struct SurfaceNoise {
    float amplitude = 0.0F;    ///< metres, of the coarsest octave: 0, or 2^-20 to 32
    uint16_t persistence = 0;  ///< amplitude of an octave over the one before, Q0.16
    uint8_t octaves = 1;       ///< 1 to 12; each halves lattice step and time step
    uint8_t step_log2 =
        9;  ///< lattice step of the coarsest octave, 2^n lattice units, 6 (6 cm) to 20; finest >= 2^4
    uint8_t period_log2 = 19;  ///< time step of the coarsest octave, 2^n us, 14 (16 ms) to 40; finest >= 2^12
    bool displayed_only = true;  ///< not in the authoritative surface
    uint32_t seed = 0;
    bool operator==(const SurfaceNoise&) const = default;
};

/// Height and derivatives, before the box's gain.
struct NoiseSample {
    float height = 0.0F;  ///< m
    float dx = 0.0F;      ///< m/m
    float dz = 0.0F;
    float dt = 0.0F;  ///< m/s
    bool operator==(const NoiseSample&) const = default;
};

/// What an octave's points share at one sea time.
struct NoiseOctave {
    uint32_t early = 0;  ///< hash of the time layer before, and after
    uint32_t late = 0;
    float since = 0.0F;       ///< position between the two, [0, 1)
    float fade = 0.0F;        ///< its quintic fade
    float fade_slope = 0.0F;  ///< the fade's derivative
    float height = 0.0F;      ///< amplitude, m
    float slope = 0.0F;       ///< amplitude over lattice step
    float rate = 0.0F;        ///< amplitude over time step, m/s
    uint8_t step_log2 = 9;    ///< lattice step, 2^n lattice units
    bool operator==(const NoiseOctave&) const = default;
};
/// The octaves, coarsest first; none where the amplitude is 0.
std::vector<NoiseOctave> octaves_at(const SurfaceNoise& noise, SeaTime t);

/// Noise of a layer at a point and time (protocol/README.md, "Surface noise"): quintic fade, sixteen gradients, octaves in order.
/// Depends on the low 32 bits of the position alone (it repeats after 4194 km, as the waves do).
NoiseSample noise_at(std::span<const NoiseOctave> octaves, LatticePoint p);
NoiseSample noise_at(const SurfaceNoise& noise, LatticePoint p, SeaTime t);

/// Bound of |height|, metres.
double noise_bound(const SurfaceNoise& noise);

Result<Done> validate(const SurfaceNoise& noise);

}  // namespace trochoid
