#include "server/import/coast_profile.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

double corner_noise(uint32_t seed, int64_t i, int64_t j) {
    const uint64_t mixed =
        splitmix64(splitmix64(splitmix64(seed) ^ static_cast<uint64_t>(i)) ^ static_cast<uint64_t>(j));
    return static_cast<double>(mixed >> 11) * 0x1p-53;
}

/// Smooth noise in 0..1 with hashed values at the corners of cells of the given size in metres.
double value_noise(uint32_t seed, double cell, EastNorth place) {
    const double x = place.east / cell;
    const double y = place.north / cell;
    const double i = std::floor(x);
    const double j = std::floor(y);
    const auto ease = [](double t) { return t * t * (3.0 - 2.0 * t); };
    const double fx = ease(x - i);
    const double fy = ease(y - j);
    const auto at = [&](int di, int dj) {
        return corner_noise(seed, static_cast<int64_t>(i) + di, static_cast<int64_t>(j) + dj);
    };
    return std::lerp(std::lerp(at(0, 0), at(1, 0), fx), std::lerp(at(0, 1), at(1, 1), fx), fy);
}

}  // namespace

double dean_depth(double a, double from_shore) { return a * std::cbrt(from_shore * from_shore); }

double capped_depth(double depth, double most) {
    const double knee = 0.5 * most;
    const double level = 1.5 * most;
    if (depth <= knee) return depth;
    if (depth >= level) return most;
    const double left = level - depth;
    return most - left * left / (2.0 * most);
}

double synthetic_land_height(const LandShape& shape, double from_shore, EastNorth place) {
    const double broad = value_noise(shape.seed, 700.0, place);
    const double fine = value_noise(shape.seed + 1, 250.0, place);
    const double step = (1.5 + 6.5 * fine * fine) * std::min(1.0, from_shore / 50.0);
    const double approach = 1.0 - std::exp(-from_shore * shape.slope / shape.top);
    const double hills = shape.top * approach * (0.25 + 0.65 * broad + 0.25 * fine);
    return std::min(shape.top, step + hills);
}

}  // namespace trochoid
