#include "protocol/model/wave_train.hpp"

#include <bit>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/model/round_wave.hpp"

namespace trochoid {

namespace {

constexpr float two_pi = 0x1.921fb6p+2F;

bool is_finite(float v) { return (std::bit_cast<uint32_t>(v) & 0x7f800000U) != 0x7f800000U; }

}  // namespace

TrainConstants derive_constants(const WaveTrain& train) {
    TrainConstants c;
    // Turns per metre: Q0.32 turns per lattice unit times 1024 units.
    const float tx = static_cast<float>(train.kx) * 0x1p-22F;
    const float tz = static_cast<float>(train.kz) * 0x1p-22F;
    const float n = std::sqrt(tx * tx + tz * tz);
    c.dx = tx / n;
    c.dz = tz / n;
    c.k = two_pi * n;
    c.kx = c.k * c.dx;
    c.kz = c.k * c.dz;
    c.a = train.amplitude;
    const float h = train.choppiness * train.amplitude;
    c.hx = h * c.dx;
    c.hz = h * c.dz;
    c.wavelength = 1.0F / n;
    c.whole = whole_wave_number(train.kx, train.kz);
    // Turns per microsecond Q0.64 to rad/s; the top 24 bits are enough and convert exactly.
    const int shift = std::countl_zero(train.omega | 1U);
    const auto top = static_cast<uint32_t>((train.omega << shift) >> 40);
    float scale = 1.0F;
    for (int i = 0; i < 24 + shift; ++i) scale *= 0.5F;
    c.omega = two_pi * ((static_cast<float>(top) * scale) * 1e6F);
    return c;
}

Result<Done> validate(const WaveTrain& train) {
    if (!is_finite(train.amplitude) || !is_finite(train.choppiness))
        return Error{ErrorCode::not_finite, "a wave train's amplitude or choppiness is not finite"};
    if (train.kx == 0 && train.kz == 0)
        return Error{ErrorCode::value_out_of_range, "a wave train has wave vector 0"};
    // The shortest wave, 2 lattice units long, would have |k| = 2^31; int32's minimum has no positive twin.
    if (train.kx == INT32_MIN || train.kz == INT32_MIN)
        return Error{ErrorCode::value_out_of_range, "a wave train is shorter than 2 lattice units"};
    if (train.amplitude != 0.0F && (train.amplitude < 0x1p-20F || train.amplitude > 32.0F))
        return Error{ErrorCode::value_out_of_range,
                     "a wave train's amplitude is neither 0 nor in 2^-20 to 32 m"};
    if (std::signbit(train.amplitude) || train.choppiness < 0.0F || train.choppiness > 4.0F)
        return Error{ErrorCode::value_out_of_range, "a wave train's choppiness is not in 0 to 4"};
    return Done{};
}

}  // namespace trochoid
