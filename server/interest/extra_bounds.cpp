#include "server/interest/extra_bounds.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/lattice.hpp"

namespace trochoid {

namespace {

constexpr double two_pi = 0x1.921fb54442d18p+2;
constexpr double q24 = 0x1p-24;
/// Covers the interpolation between two nodes of the table and the float32 evaluation.
constexpr double table_cover = 1.01;

double magnitude(double v) { return v < 0.0 ? -v : v; }

/// Bound of |grad (g cos phase)| times lambda0 for one wave system of amplitude 1. With xi = distance / lambda0 and G the
/// table's gain, g = G fall(xi) rise(xi) end(xi), where fall rise <= 3/4, fall has slope <= 1/2, rise and end have slopes <=
/// 3/4 and 3/2, and fall rise / xi <= 0.6 (the rise takes two lambda0 from the ship).
double slope_of(const std::array<WakeNode, wake_cells + 1>& nodes) {
    double steepest = 0.0;
    double gain_slope = 0.0;
    double gain_most = 0.0;
    for (size_t i = 0; i < wake_cells; ++i) {
        const WakeNode& n0 = nodes[i];
        const WakeNode& n1 = nodes[i + 1];
        const double gain = std::max(n0.gain, n1.gain) * q24;
        const double by_tau = (n1.phase - n0.phase) * 0x1p-13;
        const double tau = static_cast<double>(i + 1) / 2048.0;
        // k / k0 = (p - tau p', p')
        const double along = std::max(n0.phase, n1.phase) * q24 + tau * magnitude(by_tau);
        steepest = std::max(steepest, gain * std::sqrt(along * along + by_tau * by_tau));
        gain_slope = std::max(gain_slope, magnitude((n1.gain - n0.gain) * 0x1p-13));
        gain_most = std::max(gain_most, gain);
    }
    return table_cover * (two_pi * 0.75 * steepest + 0.6 * 1.1 * gain_slope + (0.5 + 1.5 * 2.25) * gain_most);
}

}  // namespace

double longest_wave(const ShipWake& wake) {
    if (!has_wake(wake)) return 0.0;
    return 0x1p40 / static_cast<double>(wake.inverse_length) / static_cast<double>(lattice_per_metre);
}

double longest_wave(const SurfaceNoise& noise) {
    if (noise.amplitude == 0.0F) return 0.0;
    return 2.0 * to_metres(int64_t{1} << noise.step_log2);
}

ExtraBounds wake_extra(const ShipWake& wake) {
    if (!has_wake(wake)) return {};
    static const double transverse = slope_of(wake_table().transverse);
    static const double diverging = slope_of(wake_table().diverging);
    ExtraBounds out;
    const auto choppiness = static_cast<double>(wake.choppiness);
    out.longest = longest_wave(wake);
    out.height = wake_bound(wake) * table_cover;
    out.displacement = choppiness * out.height;
    out.slope = (static_cast<double>(wake.transverse) * transverse +
                 static_cast<double>(wake.diverging) * diverging) /
                out.longest;
    out.steepness = choppiness * out.slope;
    return out;
}

ExtraBounds noise_extra(const SurfaceNoise& noise) {
    if (noise.amplitude == 0.0F) return {};
    ExtraBounds out;
    out.longest = longest_wave(noise);
    out.height = noise_bound(noise);
    // A component per cell: a gradient's 1, and the fade's slope 15/8 times what two neighbours differ by, 2 at most.
    constexpr double component = 1.0 + 1.875 * 2.0;
    double amplitude = static_cast<double>(noise.amplitude);
    double step = to_metres(int64_t{1} << noise.step_log2);
    for (uint32_t i = 0; i < noise.octaves; ++i) {
        out.slope += component * 1.4143 * amplitude / step;
        amplitude *= static_cast<double>(noise.persistence) * 0x1p-16;
        step *= 0.5;
    }
    return out;
}

}  // namespace trochoid
