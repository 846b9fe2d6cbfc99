#pragma once
#include <cstdint>

namespace trochoid {

/// Full roundness, Q1.15: the sides lag by up to 45 degrees.
inline constexpr uint16_t full_roundness = 1 << 15;

/// Wave numbers in a box of round waves are below 2^25 (waves of 0.125 m), so that P >> 31 converts to float exactly on every device.
inline constexpr uint32_t largest_round_wave_number = 1U << 25;

/// Shift of a train in a box of round waves and its slope across the box.
struct RoundShift {
    uint32_t shift = 0;  ///< turns, Q0.32
    float slope = 0.0F;  ///< d shift / d v, rad/m
    bool operator==(const RoundShift&) const = default;
};

/// Integer square root, rounded down, of kx^2 + kz^2: the wave number in turns per lattice unit, Q0.32.
uint32_t whole_wave_number(int32_t kx, int32_t kz);

/// Round waves (paper A, eq. 10 as mended in protocol/README.md, "Round waves"; row A8): with v held within [0, width],
/// a = |v - width/2|, f = min((a * (2^40 / width)) >> 9, 2^30) (a / width, Q0.31), n = (wave_number * roundness) >> 15 and
/// P = f * n (64 bits): shift = low32(a * (P >> 31)) + low32((a * (P & 0x7fffffff)) >> 31),
/// slope = sign(v - width/2) * (float(P >> 31) * 2^-21) * 2pi. Crests lag towards the sides. width: 2^10 to 2^30, so that each
/// product is one of 32 by 32 bits.
RoundShift round_shift(uint16_t roundness, uint32_t wave_number, int64_t width, int64_t v);

}  // namespace trochoid
