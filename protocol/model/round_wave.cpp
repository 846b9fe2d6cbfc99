#include "protocol/model/round_wave.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

constexpr float two_pi = 0x1.921fb6p+2F;

}  // namespace

uint32_t whole_wave_number(int32_t kx, int32_t kz) {
    auto rest = static_cast<uint64_t>(int64_t{kx} * kx) + static_cast<uint64_t>(int64_t{kz} * kz);
    uint64_t root = 0;
    // Digit by digit: root grows by one bit a step, rest is what its square leaves.
    for (uint64_t bit = uint64_t{1} << 62; bit != 0; bit >>= 2) {
        const bool fits = rest >= root + bit;
        if (fits) rest -= root + bit;
        root = (root >> 1) + (fits ? bit : 0);
    }
    return static_cast<uint32_t>(root);
}

RoundShift round_shift(uint16_t roundness, uint32_t wave_number, int64_t width, int64_t v) {
    TROCHOID_ASSERT(width > 0, "round waves in a box of width {}", width);
    const int64_t middle = width / 2;
    const int64_t off = std::clamp<int64_t>(v, 0, width) - middle;
    const auto a = static_cast<uint64_t>(off < 0 ? -off : off);
    const uint64_t reciprocal = (uint64_t{1} << 40) / static_cast<uint64_t>(width);
    const uint64_t f = std::min((a * reciprocal) >> 9, uint64_t{1} << 30);
    const uint64_t n = (uint64_t{wave_number} * roundness) >> 15;
    const uint64_t product = f * n;
    const uint64_t whole = product >> 31;
    const uint64_t part = product & 0x7fffffffU;
    RoundShift out;
    out.shift = static_cast<uint32_t>(a * whole) + static_cast<uint32_t>((a * part) >> 31);
    const float steepness = (static_cast<float>(static_cast<uint32_t>(whole)) * 0x1p-21F) * two_pi;
    out.slope = off < 0 ? -steepness : steepness;
    return out;
}

}  // namespace trochoid
