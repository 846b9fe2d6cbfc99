#include "server/world/dispersion.hpp"

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

}  // namespace

double deep_omega(double wave_number) {
    return std::sqrt(gravity * wave_number + surface_tension * wave_number * wave_number * wave_number);
}

double deep_wave_number(double omega) {
    TROCHOID_ASSERT(omega > 0.0 && omega <= 1000.0, "frequency {} rad/s", omega);
    // Newton from above on a convex, rising function: it only falls, and from gravity's root it needs at most a
    // dozen steps in the range.
    double k = omega * omega / gravity;
    for (int step = 0; step < 24; ++step) {
        const double excess = gravity * k + surface_tension * k * k * k - omega * omega;
        k -= excess / (gravity + 3.0 * surface_tension * k * k);
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

uint64_t quantised_omega(QuantisedVector k) {
    const double radians_per_second = deep_omega(wave_number_of(k));
    const double turns_per_microsecond = radians_per_second / (2.0 * pi * 1e6);
    return static_cast<uint64_t>(turns_per_microsecond * 0x1p64 + 0.5);
}

double deep_group_speed(double omega) { return gravity / (2.0 * omega); }

}  // namespace trochoid
