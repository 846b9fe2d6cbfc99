#include "server/world/dispersion.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

/// rad/m of one unit of Q0.32 turns per lattice unit: 2π · 1024 / 2^32.
constexpr double radians_per_unit = 2.0 * pi * 0x1p-22;

int32_t nearest(double value) {
    TROCHOID_ASSERT(value > -2147483647.0 && value < 2147483647.0, "wave vector component {} units", value);
    return static_cast<int32_t>(value < 0.0 ? value - 0.5 : value + 0.5);
}

/// g k + (γ/ρ) k³: ω² on deep water.
double deep_square(double k) { return k * (gravity + surface_tension * k * k); }

/// d ln(ω²) / d ln k: between 1 (gravity, deep) and 4 (ripples on a film).
double doubled_slope(double k, double kd, double tangent) {
    const double tension = surface_tension * k * k;
    const double deep = (gravity + 3.0 * tension) / (gravity + tension);
    // 2x / sinh 2x = x (1 - tanh² x) / tanh x
    const double bed = kd >= 22.0 ? 0.0 : kd * ((1.0 - tangent) * (1.0 + tangent)) / tangent;
    return deep + bed;
}

}  // namespace

double wave_omega(double wave_number, double depth) {
    return std::sqrt(deep_square(wave_number) * hyperbolic_tangent(wave_number * depth));
}

double wave_number_at(double omega, double depth) {
    TROCHOID_ASSERT(omega > 0.0 && depth > 0.0, "frequency {} rad/s over {} m", omega, depth);
    const double square = omega * omega;
    const double deep = deep_wave_number(omega);
    if (deep * depth >= 22.0) return deep;
    // tanh x <= x, so the root of g D k² + s D k⁴ = ω² is a lower bound, like the deep one. The quadratic's stable form.
    const double b = gravity * depth;
    const double shallow =
        std::sqrt(2.0 * square / (b + std::sqrt(b * b + 4.0 * surface_tension * depth * square)));
    // Newton on ln ω² over ln k, whose slope lies between 1 and 4: from within a sixth of the root.
    double k = std::max(deep, shallow);
    for (int step = 0; step < 8; ++step) {
        const double tangent = hyperbolic_tangent(k * depth);
        const double reached = deep_square(k) * tangent;
        k = k + k * ((square - reached) / (reached * doubled_slope(k, k * depth, tangent)));
    }
    return k;
}

double group_speed_at(double wave_number, double depth) {
    const double kd = wave_number * depth;
    const double tangent = hyperbolic_tangent(kd);
    const double omega = std::sqrt(deep_square(wave_number) * tangent);
    return omega / (2.0 * wave_number) * doubled_slope(wave_number, kd, tangent);
}

double deep_omega(double wave_number) { return std::sqrt(deep_square(wave_number)); }

double deep_wave_number(double omega) {
    TROCHOID_ASSERT(omega > 0.0 && omega <= 2000.0, "frequency {} rad/s", omega);
    // Newton from above on a convex, rising function: it only falls, from gravity's root in at most two dozen steps.
    const double square = omega * omega;
    double k = square / gravity;
    for (int step = 0; step < 24; ++step) {
        const double tension = surface_tension * k * k;
        k -= (k * (gravity + tension) - square) / (gravity + 3.0 * tension);
    }
    return k;
}

QuantisedVector quantise(double wave_number, HeadingVector direction) {
    const double units = wave_number / radians_per_unit;
    return {nearest(units * direction.east), nearest(units * direction.south)};
}

double wave_number_of(QuantisedVector k) {
    const int64_t square = int64_t{k.kx} * k.kx + int64_t{k.kz} * k.kz;
    return std::sqrt(static_cast<double>(square)) * radians_per_unit;
}

uint64_t quantised_omega(QuantisedVector k, double depth) {
    const double radians_per_second = wave_omega(wave_number_of(k), depth);
    const double turns_per_microsecond = radians_per_second / (2.0 * pi * 1e6);
    return static_cast<uint64_t>(turns_per_microsecond * 0x1p64 + 0.5);
}

}  // namespace trochoid
