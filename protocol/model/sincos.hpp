#pragma once
#include <bit>
#include <cstdint>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

/// Sine and cosine of one phase.
struct SinCos {
    float sin = 0.0F;
    float cos = 1.0F;
};

/// Bits of the minimax coefficients on an eighth of a turn each side, argument scaled to [-1, 1). Normative: shaders
/// and other languages use these bits, never decimals.
namespace sincos_bits {
inline constexpr uint32_t s1 = 0x3f490fda;
inline constexpr uint32_t s3 = 0xbda55dbe;
inline constexpr uint32_t s5 = 0x3b232873;
inline constexpr uint32_t s7 = 0xb815dfa5;
inline constexpr uint32_t c2 = 0xbe9de9d1;
inline constexpr uint32_t c4 = 0x3c81d8c7;
inline constexpr uint32_t c6 = 0xb9a7588a;
}  // namespace sincos_bits

/// Sine and cosine of a phase in turns, Q0.32 (1 turn = 2^32). Largest absolute error 1.6e-7 (bound borne by the
/// test); integers, float products and sums only, so the bits agree on every machine.
inline SinCos sincos_turns(uint32_t phase) {
    using namespace sincos_bits;
    const float t = static_cast<float>(static_cast<int32_t>(phase << 2) >> 8) * 0x1p-23F;
    const float z = t * t;
    const float sine =
        t * (std::bit_cast<float>(s1) +
             z * (std::bit_cast<float>(s3) + z * (std::bit_cast<float>(s5) + z * std::bit_cast<float>(s7))));
    const float cosine =
        1.0F + z * (std::bit_cast<float>(c2) + z * (std::bit_cast<float>(c4) + z * std::bit_cast<float>(c6)));
    const uint32_t q = phase + 0x20000000U;
    const bool swapped = (q & 0x40000000U) != 0;
    const uint32_t sine_bits = std::bit_cast<uint32_t>(swapped ? cosine : sine) ^ (q & 0x80000000U);
    const uint32_t cosine_bits =
        std::bit_cast<uint32_t>(swapped ? sine : cosine) ^ ((q + 0x40000000U) & 0x80000000U);
    return {std::bit_cast<float>(sine_bits), std::bit_cast<float>(cosine_bits)};
}

}  // namespace trochoid
