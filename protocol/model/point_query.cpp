#include "protocol/model/point_query.hpp"

#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

constexpr int newton_steps = 4;
constexpr float longest_step = 65536.0F;  // lattice units, 64 m

/// Nearest integer, halves to even, for |v| <= 65536. Adding and taking away 1.5 * 2^23 rounds in the ALU itself.
int64_t round_half_even(float v) {
    volatile float shifted = v + 0x1.8p+23F;
    return static_cast<int64_t>(shifted - 0x1.8p+23F);
}

float clamp_step(float v) {
    // Written so that a NaN (which only a broken record could give) becomes 0.
    if (v >= longest_step) return longest_step;
    if (v <= -longest_step) return -longest_step;
    return v == v ? v : 0.0F;
}

}  // namespace

WaterPoint water_at(const SeaInstant& sea, LatticePoint place) {
    LatticePoint rest = place;
    SurfaceSample s = sea.evaluate(rest);
    for (int step = 0; step < newton_steps; ++step) {
        const float fx = static_cast<float>(rest.x - place.x) * 0x1p-10F - s.ax;
        const float fz = static_cast<float>(rest.z - place.z) * 0x1p-10F - s.az;
        const float det = s.pxx * s.pzz - s.pxz * s.pzx;
        const float dx = (s.pzz * fx - s.pxz * fz) / det;
        const float dz = (s.pxx * fz - s.pzx * fx) / det;
        rest.x -= round_half_even(clamp_step(1024.0F * dx));
        rest.z -= round_half_even(clamp_step(1024.0F * dz));
        s = sea.evaluate(rest);
    }
    WaterPoint out;
    out.height = s.ay;
    const float n = std::sqrt((s.nx * s.nx + s.ny * s.ny) + s.nz * s.nz);
    out.nx = s.nx / n;
    out.ny = s.ny / n;
    out.nz = s.nz / n;
    out.vx = s.vx;
    out.vy = s.vy;
    out.vz = s.vz;
    out.rest = rest;
    return out;
}

}  // namespace trochoid
