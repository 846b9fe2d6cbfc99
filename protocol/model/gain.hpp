#pragma once
#include <cstdint>

// Fixed-point gains of envelopes, land and wakes (protocol/README.md, 2.5 and 2.7).
namespace trochoid {

/// Product of two gains, Q0.24, rounded down.
constexpr uint32_t times(uint32_t a, uint32_t b) {
    return static_cast<uint32_t>((static_cast<uint64_t>(a) * b) >> 24);
}

/// A gain below 2^26, Q0.24, by its upper 24 bits: the conversion is exact on every device.
constexpr float gain_to_float(uint32_t gain) { return static_cast<float>(gain >> 2) * 0x1p-22F; }

}  // namespace trochoid
