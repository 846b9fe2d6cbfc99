#include "server/world/box_effects.hpp"

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/model/round_wave.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/train_spectrum.hpp"

namespace trochoid {

namespace {

uint16_t share_of(double share) {
    return static_cast<uint16_t>(share * static_cast<double>(full_irregularity) + 0.5);
}

/// rad/s as turns per microsecond, Q0.64.
uint64_t frequency_units(double radians_per_second) {
    return static_cast<uint64_t>(radians_per_second / (2.0 * pi * 1e6) * 0x1p64 + 0.5);
}

/// kx X + kz Z at a point, turns Q0.32.
uint32_t phase_at(QuantisedVector k, LatticePoint p) {
    const auto low = [](int64_t value) { return static_cast<uint32_t>(static_cast<uint64_t>(value)); };
    return static_cast<uint32_t>(k.kx) * low(p.x) + static_cast<uint32_t>(k.kz) * low(p.z);
}

IrregularHeight with_vectors(double share, QuantisedVector along, QuantisedVector across) {
    IrregularHeight heights;
    heights.share = share_of(share);
    heights.ukx = along.kx;
    heights.ukz = along.kz;
    heights.vkx = across.kx;
    heights.vkz = across.kz;
    return heights;
}

}  // namespace

uint16_t roundness_units(double roundness) {
    return static_cast<uint16_t>(roundness * static_cast<double>(full_roundness) + 0.5);
}

IrregularHeight grouped_heights(double share, HeadingVector u, double along, double across,
                                double group_speed, uint64_t seed) {
    if (share_of(share) == 0) return {};
    const QuantisedVector k = quantise(2.0 * pi / along, u);
    IrregularHeight heights = with_vectors(share, k, quantise(2.0 * pi / across, {-u.south, u.east}));
    heights.omega = frequency_units(group_speed * wave_number_of(k));
    heights.phase_u = static_cast<uint32_t>(draw(seed, Stream::groups, 0) >> 32);
    heights.phase_v = static_cast<uint32_t>(draw(seed, Stream::groups, 1) >> 32);
    return heights;
}

IrregularHeight literal_heights(double share, HeadingVector u, double along, double across,
                                LatticePoint corner) {
    if (share_of(share) == 0) return {};
    // sin(t + u') = sin(half a turn - u' - t): the pattern's wave vector points against u.
    const QuantisedVector k = quantise(2.0 * pi / along, {-u.east, -u.south});
    const QuantisedVector side = quantise(2.0 * pi / across, {-u.south, u.east});
    IrregularHeight heights = with_vectors(share, k, side);
    heights.omega = frequency_units(1.0);
    heights.phase_u = (uint32_t{1} << 31) - phase_at(k, corner);
    heights.phase_v = 0U - phase_at(side, corner);
    return heights;
}

SurfaceNoise capillary_noise(float amplitude, uint64_t seed) {
    SurfaceNoise noise;
    if (amplitude == 0.0F) return noise;
    noise.amplitude = amplitude;
    noise.persistence = 1U << 15;
    noise.octaves = 3;
    noise.step_log2 = 9;
    noise.period_log2 = 18;
    noise.displayed_only = true;
    noise.seed = static_cast<uint32_t>(draw(seed, Stream::noise, 0) >> 32);
    return noise;
}

}  // namespace trochoid
