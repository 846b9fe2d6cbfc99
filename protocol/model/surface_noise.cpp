#include "protocol/model/surface_noise.hpp"

#include <bit>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

/// A noise value with its derivatives per cell.
struct Jet {
    float value = 0.0F;
    float dx = 0.0F;
    float dz = 0.0F;
    float dt = 0.0F;
};

/// Integer hash by two rounds of multiply and xor-shift (Wellons' lowbias32).
uint32_t mix(uint32_t v) {
    v ^= v >> 16;
    v *= 0x7feb352dU;
    v ^= v >> 15;
    v *= 0x846ca68bU;
    return v ^ (v >> 16);
}

/// The sixteen gradients: two of the three components are +1 or -1, four of the twelve come twice. Bits 0 and 1 of the hash's top
/// four are the signs, bits 2 and 3 choose the components: 00 x and z, 01 x and t, 10 z and t, 11 x and z again.
Jet corner(uint32_t hash, float fx, float fz, float ft) {
    const uint32_t top = hash >> 28;
    const float first = (top & 1U) != 0 ? -1.0F : 1.0F;
    const float second = (top & 2U) != 0 ? -1.0F : 1.0F;
    const uint32_t pair = top >> 2;
    Jet j;
    j.dx = pair == 2 ? 0.0F : first;
    j.dz = pair == 1 ? 0.0F : (pair == 2 ? first : second);
    j.dt = pair == 1 || pair == 2 ? second : 0.0F;
    j.value = (j.dx * fx + j.dz * fz) + j.dt * ft;
    return j;
}

float blend(float a, float b, float w) { return a + w * (b - a); }

Jet blend(const Jet& a, const Jet& b, float w) {
    return {blend(a.value, b.value, w), blend(a.dx, b.dx, w), blend(a.dz, b.dz, w), blend(a.dt, b.dt, w)};
}

/// 6f^5 - 15f^4 + 10f^3 and its derivative (Perlin, "Improving noise", 2002).
float fade(float f) { return ((f * f) * f) * (f * (f * 6.0F - 15.0F) + 10.0F); }
float fade_slope(float f) { return (30.0F * (f * f)) * ((f - 1.0F) * (f - 1.0F)); }

/// Metres: octaves below are left out, so that nothing comes near the subnormals.
constexpr float smallest_octave = 0x1p-24F;

constexpr uint32_t column_factor = 0x8da6b343U;
constexpr uint32_t row_factor = 0xd8163841U;
constexpr uint32_t layer_factor = 0xcb1ab31fU;
constexpr uint32_t octave_factor = 0x9e3779b9U;

Jet octave_at(const NoiseOctave& o, LatticePoint p) {
    const auto x = static_cast<uint32_t>(static_cast<uint64_t>(p.x));
    const auto z = static_cast<uint32_t>(static_cast<uint64_t>(p.z));
    const uint32_t in_cell = (1U << o.step_log2) - 1U;
    // The last column's right neighbour is column 0: no seam at 2^32 lattice units.
    const uint32_t cells = 0xffffffffU >> o.step_log2;
    const uint32_t column[2] = {(x >> o.step_log2) * column_factor,
                                (((x >> o.step_log2) + 1U) & cells) * column_factor};
    const uint32_t row[2] = {(z >> o.step_log2) * row_factor,
                             (((z >> o.step_log2) + 1U) & cells) * row_factor};
    const float per_unit = std::bit_cast<float>((127U - o.step_log2) << 23);
    const float fx = static_cast<float>(x & in_cell) * per_unit;
    const float fz = static_cast<float>(z & in_cell) * per_unit;
    const float wx = fade(fx);
    const float wz = fade(fz);
    Jet rows[2][2];
    float rows_dx[2][2];
    for (int t = 0; t < 2; ++t)
        for (int r = 0; r < 2; ++r) {
            const uint32_t base = (t == 0 ? o.early : o.late) + row[r];
            const float at_z = r == 0 ? fz : fz - 1.0F;
            const float at_t = t == 0 ? o.since : o.since - 1.0F;
            const Jet west = corner(mix(base + column[0]), fx, at_z, at_t);
            const Jet east = corner(mix(base + column[1]), fx - 1.0F, at_z, at_t);
            rows[t][r] = blend(west, east, wx);
            rows_dx[t][r] = east.value - west.value;
        }
    const float sx = fade_slope(fx);
    const float sz = fade_slope(fz);
    Jet layers[2];
    for (int t = 0; t < 2; ++t) {
        for (int r = 0; r < 2; ++r) rows[t][r].dx = rows[t][r].dx + sx * rows_dx[t][r];
        layers[t] = blend(rows[t][0], rows[t][1], wz);
        layers[t].dz = layers[t].dz + sz * (rows[t][1].value - rows[t][0].value);
    }
    Jet out = blend(layers[0], layers[1], o.fade);
    out.dt = out.dt + o.fade_slope * (layers[1].value - layers[0].value);
    return out;
}

Result<Done> range_error(const char* message) { return Error{ErrorCode::value_out_of_range, message}; }

}  // namespace

std::vector<NoiseOctave> octaves_at(const SurfaceNoise& noise, SeaTime t) {
    std::vector<NoiseOctave> octaves;
    if (noise.amplitude == 0.0F) return octaves;
    octaves.reserve(noise.octaves);
    const float persistence = static_cast<float>(noise.persistence) * 0x1p-16F;
    float amplitude = noise.amplitude;
    for (uint32_t i = 0; i < noise.octaves && amplitude >= smallest_octave; ++i) {
        NoiseOctave o;
        o.step_log2 = static_cast<uint8_t>(noise.step_log2 - i);
        const uint32_t period_log2 = noise.period_log2 - i;
        const uint32_t seed = mix(noise.seed + i * octave_factor);
        const auto layer = static_cast<uint32_t>(static_cast<uint64_t>(t.us >> period_log2));
        o.early = mix(layer * layer_factor + seed);
        o.late = mix((layer + 1U) * layer_factor + seed);
        // At most 24 bits of the time step are read, so the conversion is exact.
        const int64_t in_step = t.us & ((int64_t{1} << period_log2) - 1);
        const uint32_t bits = period_log2 > 24 ? 24 : period_log2;
        o.since =
            static_cast<float>(in_step >> (period_log2 - bits)) * std::bit_cast<float>((127U - bits) << 23);
        o.fade = fade(o.since);
        o.fade_slope = fade_slope(o.since);
        o.height = amplitude;
        o.slope = amplitude * std::bit_cast<float>((137U - o.step_log2) << 23);
        o.rate = amplitude * (1e6F * std::bit_cast<float>((127U - period_log2) << 23));
        octaves.push_back(o);
        amplitude = amplitude * persistence;
    }
    return octaves;
}

NoiseSample noise_at(std::span<const NoiseOctave> octaves, LatticePoint p) {
    NoiseSample sum;
    for (const NoiseOctave& o : octaves) {
        const Jet j = octave_at(o, p);
        sum.height = o.height * j.value + sum.height;
        sum.dx = o.slope * j.dx + sum.dx;
        sum.dz = o.slope * j.dz + sum.dz;
        sum.dt = o.rate * j.dt + sum.dt;
    }
    return sum;
}

NoiseSample noise_at(const SurfaceNoise& noise, LatticePoint p, SeaTime t) {
    return noise_at(octaves_at(noise, t), p);
}

double noise_bound(const SurfaceNoise& noise) {
    // No choice of gradients takes an octave above 1.04 times its amplitude (brute force in the test).
    constexpr double octave_bound = 1.05;
    double sum = 0.0;
    double amplitude = static_cast<double>(noise.amplitude);
    for (uint32_t i = 0; i < noise.octaves; ++i) {
        sum += amplitude;
        amplitude *= static_cast<double>(noise.persistence) * 0x1p-16;
    }
    return sum * octave_bound;
}

Result<Done> validate(const SurfaceNoise& noise) {
    if ((std::bit_cast<uint32_t>(noise.amplitude) & 0x7f800000U) == 0x7f800000U)
        return Error{ErrorCode::not_finite, "surface noise: the amplitude is not finite"};
    if (std::signbit(noise.amplitude) ||
        (noise.amplitude != 0.0F && (noise.amplitude < 0x1p-20F || noise.amplitude > 32.0F)))
        return range_error("surface noise: the amplitude is neither 0 nor in 2^-20 to 32 m");
    if (noise.octaves < 1 || noise.octaves > 12) return range_error("surface noise: not 1 to 12 octaves");
    const int finer = noise.octaves - 1;
    if (noise.step_log2 < 6 || noise.step_log2 > 20 || noise.step_log2 - finer < 4)
        return range_error(
            "surface noise: the lattice step is not 2^6 to 2^20 units, the finest octave's 2^4 or more");
    if (noise.period_log2 < 14 || noise.period_log2 > 40 || noise.period_log2 - finer < 12)
        return range_error(
            "surface noise: the time step is not 2^14 to 2^40 us, the finest octave's 2^12 or more");
    return Done{};
}

}  // namespace trochoid
