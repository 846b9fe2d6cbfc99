#include "server/world/spectrum.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"
#include "protocol/units/lattice.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/integer_math.hpp"

namespace trochoid {

namespace {

constexpr size_t cells = 2048;
constexpr double lowest_share_of_peak = 0.5;
constexpr double highest_share_of_peak = 4.0;
/// ω of a 5 cm wave, rad/s.
constexpr double highest_omega = 37.08;

/// The place of `value` in a rising list: the cell and the part of it, both clamped.
struct Place {
    size_t cell;
    double part;
};

Place place_in(const std::vector<double>& nodes, double value) {
    const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, value);
    const auto cell = static_cast<size_t>(above - nodes.begin()) - 1;
    const double width = nodes[cell + 1] - nodes[cell];
    // Where a spectrum has no energy a cell has no width.
    return {cell, width > 0.0 ? std::clamp((value - nodes[cell]) / width, 0.0, 1.0) : 1.0};
}

double between(const std::vector<double>& values, Place at) {
    return values[at.cell] + (values[at.cell + 1] - values[at.cell]) * at.part;
}

}  // namespace

double wind_at_height(double speed, double height) {
    // √Cd / κ
    constexpr double shear = 0.09013878188659973;
    const double log_ten = natural_log(10.0);
    const auto profile = [&](double z) { return 1.0 + shear * (natural_log(z) - log_ten); };
    return speed * (profile(height) / profile(19.5));
}

FrequencyRange used_range(FrequencyRange asked, double peak_omega) {
    TROCHOID_ASSERT(asked.low > 0.0 && asked.low < asked.high && peak_omega > 0.0,
                    "frequencies {} to {}, peak {} rad/s", asked.low, asked.high, peak_omega);
    return {std::min(asked.low, lowest_share_of_peak * peak_omega),
            std::max(asked.high, std::min(highest_share_of_peak * peak_omega, highest_omega))};
}

FrequencySpectrum::FrequencySpectrum(Spectrum kind, double wind_speed, double wind_height, double peak_omega,
                                     Form form, FrequencyRange asked)
    : kind_(kind),
      wind_speed_(wind_speed),
      wind_height_(wind_height),
      peak_omega_(peak_omega),
      form_(form),
      range_(used_range(asked, peak_omega)) {
    integrate();
}

FrequencySpectrum FrequencySpectrum::pierson_moskowitz(double u19_5, FrequencyRange asked) {
    TROCHOID_ASSERT(u19_5 > 0.0, "wind of {} m/s", u19_5);
    constexpr double alpha = 0.0081;
    constexpr double beta = 0.74;
    const double ratio = gravity / u19_5;
    const double decay = beta * ((ratio * ratio) * (ratio * ratio));
    const double peak = std::sqrt(std::sqrt(0.8 * decay));
    return {
        Spectrum::pierson_moskowitz, u19_5, 19.5, peak, {alpha * gravity * gravity, 5, decay, 4, 0.0}, asked};
}

FrequencySpectrum FrequencySpectrum::jonswap(double u10, double fetch_metres, FrequencyRange asked,
                                             double gamma) {
    TROCHOID_ASSERT(u10 > 0.0 && fetch_metres > 0.0 && gamma >= 1.0 && gamma <= 10.0,
                    "wind of {} m/s over {} m, gamma {}", u10, fetch_metres, gamma);
    const double x = std::min(gravity * fetch_metres / (u10 * u10), jonswap_full_development);
    const double alpha = 0.076 * power(x, -0.22);
    const double peak = 22.0 * (gravity / u10) / cube_root(x);
    const double square = peak * peak;
    return {Spectrum::jonswap,
            u10,
            10.0,
            peak,
            {alpha * gravity * gravity, 5, 1.25 * (square * square), 4, natural_log(gamma)},
            asked};
}

FrequencySpectrum FrequencySpectrum::neumann(double u7_5, FrequencyRange asked) {
    TROCHOID_ASSERT(u7_5 > 0.0, "wind of {} m/s", u7_5);
    constexpr double c = 3.05;
    const double ratio = gravity / u7_5;
    const double decay = 2.0 * (ratio * ratio);
    return {Spectrum::neumann, u7_5, 7.5, std::sqrt(decay / 3.0), {c * pi / 4.0, 6, decay, 2, 0.0}, asked};
}

double FrequencySpectrum::density(double omega) const {
    TROCHOID_ASSERT(omega > 0.0, "frequency {} rad/s", omega);
    const double inverse = 1.0 / omega;
    const double square = inverse * inverse;
    const double steep = form_.steep == 4 ? square * square : square;
    double exponent = -form_.decay * steep;
    if (form_.log_gamma != 0.0) {
        const double deviation = (omega / peak_omega_ - 1.0) / (omega <= peak_omega_ ? 0.07 : 0.09);
        exponent += form_.log_gamma * exponential(-0.5 * (deviation * deviation));
    }
    const double falling = square * square * (form_.power == 6 ? square : inverse);
    return form_.scale * falling * exponential(exponent);
}

void FrequencySpectrum::integrate() {
    const double half_cell = natural_log(range_.high / range_.low) / static_cast<double>(2 * cells);
    const double half_ratio = exponential(half_cell);
    omega_.assign(1, range_.low);
    energy_.assign(1, 0.0);
    omega_.reserve(cells + 1);
    energy_.reserve(cells + 1);
    // Simpson over ln ω: the integrand of ωⁿ S dω is ωⁿ⁺¹ S.
    double low = range_.low;
    double s_low = density(low) * low;
    for (size_t i = 0; i < cells; ++i) {
        const double middle = low * half_ratio;
        const double high = i + 1 == cells ? range_.high : middle * half_ratio;
        const double s_middle = 4.0 * (density(middle) * middle);
        const double s_high = density(high) * high;
        const double part = half_cell / 3.0;
        energy_.push_back(energy_.back() + part * (s_low + s_middle + s_high));
        omega_.push_back(high);
        m1_ += part * (s_low * low + s_middle * middle + s_high * high);
        m2_ += part * (s_low * low * low + s_middle * middle * middle + s_high * high * high);
        low = high;
        s_low = s_high;
    }
}

double FrequencySpectrum::significant_height() const { return 4.0 * std::sqrt(m0()); }

double FrequencySpectrum::cumulative(double omega) const { return between(energy_, place_in(omega_, omega)); }

double FrequencySpectrum::quantile(double quantile) const {
    TROCHOID_ASSERT(quantile >= 0.0 && quantile <= 1.0, "quantile {}", quantile);
    return between(omega_, place_in(energy_, quantile * m0()));
}

FrequencySpectrum wind_spectrum(double speed, int64_t fetch, Spectrum spectrum, FrequencyRange asked) {
    TROCHOID_ASSERT(speed > 0.0 && fetch > 0, "wind of {} m/s over {} lattice units", speed, fetch);
    const double u10 = wind_at_height(speed, 10.0);
    const double metres = to_metres(fetch);
    Spectrum chosen = spectrum;
    if (chosen == Spectrum::automatic)
        chosen = gravity * metres / (u10 * u10) < jonswap_full_development ? Spectrum::jonswap
                                                                           : Spectrum::pierson_moskowitz;
    if (chosen == Spectrum::jonswap) return FrequencySpectrum::jonswap(u10, metres, asked);
    if (chosen == Spectrum::neumann) return FrequencySpectrum::neumann(wind_at_height(speed, 7.5), asked);
    return FrequencySpectrum::pierson_moskowitz(speed, asked);
}

}  // namespace trochoid
