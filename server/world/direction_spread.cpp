#include "server/world/direction_spread.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/integer_math.hpp"

namespace trochoid {

namespace {

constexpr size_t steps = 256;  // two a cell: its ends and its middle

struct Angles {
    std::array<double, steps + 1> cosine{};
    /// ln cos²(θ/2) = ln((1 + cos θ)/2)
    std::array<double, steps + 1> log_half{};
};

/// At 0, …, 60 degrees.
const Angles& angles() {
    static const Angles made = [] {
        Angles table;
        for (size_t i = 0; i <= steps; ++i) {
            table.cosine[i] = cosine_of_half_turns(static_cast<double>(i) / static_cast<double>(3 * steps));
            table.log_half[i] = natural_log(0.5 * (1.0 + table.cosine[i]));
        }
        return table;
    }();
    return made;
}

}  // namespace

double hasselmann_exponent(double omega, double peak_omega, double u10) {
    TROCHOID_ASSERT(omega > 0.0 && peak_omega > 0.0 && u10 > 0.0, "frequency {} of peak {}, wind {}", omega,
                    peak_omega, u10);
    const double f = omega / peak_omega;
    if (f < 1.05) return 6.97 * power(f, 4.06);
    const double inverse_age = u10 * peak_omega / gravity;
    return 9.77 * power(f, -2.33 - 1.45 * (inverse_age - 1.17));
}

DirectionSpread::DirectionSpread(Spreading spreading, double omega, double peak_omega, double u10) {
    const Angles& table = angles();
    const bool squared = spreading == Spreading::cosine_squared;
    const double s = squared ? 0.0 : hasselmann_exponent(omega, peak_omega, u10);
    const auto weight = [&](size_t i) {
        return squared ? table.cosine[i] * table.cosine[i] : exponential(s * table.log_half[i]);
    };
    constexpr double part = widest_deviation / static_cast<double>(6 * cells);
    weight_[0] = weight(0);
    for (size_t i = 1; i <= cells; ++i) {
        weight_[i] = weight(2 * i);
        share_[i] = share_[i - 1] + part * (weight_[i - 1] + 4.0 * weight(2 * i - 1) + weight_[i]);
    }
    norm_ = share_[cells];
    for (double& share : share_) share = share / norm_;
}

double DirectionSpread::density(double degrees) const {
    const double place =
        (degrees < 0.0 ? -degrees : degrees) * (static_cast<double>(cells) / widest_deviation);
    if (place > static_cast<double>(cells)) return 0.0;
    const size_t cell = std::min(static_cast<size_t>(place), cells - 1);
    const double value =
        weight_[cell] + (weight_[cell + 1] - weight_[cell]) * (place - static_cast<double>(cell));
    return value / (2.0 * norm_);
}

double DirectionSpread::cumulative(double degrees) const {
    const double away = degrees < 0.0 ? -degrees : degrees;
    const double place = std::min(away / widest_deviation, 1.0) * static_cast<double>(cells);
    const size_t cell = std::min(static_cast<size_t>(place), cells - 1);
    const double share =
        share_[cell] + (share_[cell + 1] - share_[cell]) * (place - static_cast<double>(cell));
    return degrees < 0.0 ? 0.5 - 0.5 * share : 0.5 + 0.5 * share;
}

double DirectionSpread::quantile(double quantile) const {
    TROCHOID_ASSERT(quantile >= 0.0 && quantile <= 1.0, "quantile {}", quantile);
    const double away = quantile < 0.5 ? 1.0 - 2.0 * quantile : 2.0 * quantile - 1.0;
    const auto above = std::upper_bound(share_.begin() + 1, share_.end() - 1, away);
    const auto cell = static_cast<size_t>(above - share_.begin()) - 1;
    // Both densities are above 0 up to 60 degrees, so every cell has some.
    const double part = std::clamp((away - share_[cell]) / (share_[cell + 1] - share_[cell]), 0.0, 1.0);
    const double degrees =
        (static_cast<double>(cell) + part) * (widest_deviation / static_cast<double>(cells));
    return quantile < 0.5 ? -degrees : degrees;
}

}  // namespace trochoid
