#include "server/land/finite_depth.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

constexpr int cells = 1024;

/// tanh x for 0 <= x <= 7 by Lambert's continued fraction x / (1 + x^2 / (3 + x^2 / (5 + ...))), to 1e-15.
double tanh_by_fraction(double x) {
    const double square = x * x;
    double fraction = 81.0;
    for (int odd = 79; odd >= 1; odd -= 2) fraction = static_cast<double>(odd) + square / fraction;
    return x / fraction;
}

struct FiniteDepthTable {
    /// k D / sqrt(k0 D): 1 + k0 D / 6 + ... near 0, hence fit for linear interpolation where k / k0 itself is not.
    std::array<double, cells + 1> root_scaled{};
    /// 2 cg / c = 1 + 2 k D / sinh(2 k D).
    std::array<double, cells + 1> twice_n{};
};

FiniteDepthTable make_table() {
    FiniteDepthTable table;
    table.root_scaled[0] = 1.0;
    table.twice_n[0] = 2.0;
    for (int i = 1; i <= cells; ++i) {
        const double deep_kd = two_pi_f64 * static_cast<double>(i) / static_cast<double>(cells);
        // Newton on x tanh x = deep_kd from above: convex there, so it converges monotonically.
        double x = deep_kd + 1.0;
        double th = tanh_by_fraction(x);
        for (int step = 0; step < 12; ++step) {
            x = x - (x * th - deep_kd) / (th + x * (1.0 - th * th));
            th = tanh_by_fraction(x);
        }
        const auto at = static_cast<size_t>(i);
        table.root_scaled[at] = x / std::sqrt(deep_kd);
        // sinh 2x = 2 tanh x / (1 - tanh^2 x)
        table.twice_n[at] = 1.0 + x * (1.0 - th * th) / th;
    }
    return table;
}

const FiniteDepthTable& table() {
    static const FiniteDepthTable made = make_table();
    return made;
}

struct Place {
    size_t cell;
    double fraction;
};

Place place_of(double deep_kd) {
    const double scaled = deep_kd * (static_cast<double>(cells) / two_pi_f64);
    if (scaled >= static_cast<double>(cells)) return {cells - 1, 1.0};
    const auto cell = static_cast<size_t>(scaled);
    return {cell, scaled - static_cast<double>(cell)};
}

double lerp(const std::array<double, cells + 1>& values, Place at) {
    return values[at.cell] + (values[at.cell + 1] - values[at.cell]) * at.fraction;
}

double capped(double deep_kd) { return deep_kd < two_pi_f64 ? deep_kd : two_pi_f64; }

}  // namespace

double tanh_of(double x) {
    if (x >= 20.0) return 1.0;
    if (x <= 5.0) return tanh_by_fraction(x);
    // tanh 2y = 2 tanh y / (1 + tanh^2 y)
    const double half = tanh_of(x * 0.5);
    return 2.0 * half / (1.0 + half * half);
}

double wave_number_ratio(double deep_kd) {
    const double kd = capped(deep_kd);
    return lerp(table().root_scaled, place_of(kd)) / std::sqrt(kd);
}

double shoaling_ratio(double deep_kd) {
    const double kd = capped(deep_kd);
    const Place at = place_of(kd);
    const double ratio = lerp(table().root_scaled, at) / std::sqrt(kd);
    return std::sqrt(ratio / lerp(table().twice_n, at));
}

}  // namespace trochoid
