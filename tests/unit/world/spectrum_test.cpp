#include "server/world/spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "protocol/units/lattice.hpp"
#include "server/world/dispersion.hpp"

namespace trochoid {
namespace {

/// Midpoint sum of ωⁿ S over [low, high]: slow and obvious.
double plain_moment(const std::function<double(double)>& density, int n, double low, double high) {
    const int steps = 100'000;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double w = low + (high - low) * (i + 0.5) / steps;
        sum += std::pow(w, n) * density(w);
    }
    return sum * (high - low) / steps;
}

/// The textbook formulas, with libm.
double plain_pierson_moskowitz(double w, double u) {
    return 0.0081 * gravity * gravity * std::pow(w, -5.0) *
           std::exp(-0.74 * std::pow(gravity / (u * w), 4.0));
}
double plain_jonswap(double w, double u, double fetch) {
    const double x = gravity * fetch / (u * u);
    const double peak = 22.0 * std::cbrt(gravity * gravity / (u * fetch));
    const double alpha = 0.076 * std::pow(u * u / (fetch * gravity), 0.22);
    EXPECT_LT(x, jonswap_full_development);
    const double sigma = w <= peak ? 0.07 : 0.09;
    const double r = std::exp(-(w - peak) * (w - peak) / (2.0 * sigma * sigma * peak * peak));
    return alpha * gravity * gravity * std::pow(w, -5.0) * std::exp(-1.25 * std::pow(peak / w, 4.0)) *
           std::pow(3.3, r);
}
double plain_neumann(double w, double u) {
    return 3.05 * pi / 4.0 * std::pow(w, -6.0) * std::exp(-2.0 * gravity * gravity / (u * u * w * w));
}

struct Case {
    FrequencySpectrum spectrum;
    std::function<double(double)> plain;
};

std::vector<Case> cases() {
    std::vector<Case> list;
    for (const double u : {5.0, 12.0, 25.0}) {
        list.push_back({FrequencySpectrum::pierson_moskowitz(u),
                        [u](double w) { return plain_pierson_moskowitz(w, u); }});
        list.push_back({FrequencySpectrum::neumann(u), [u](double w) { return plain_neumann(w, u); }});
        for (const double fetch : {4000.0, 25'000.0})
            list.push_back({FrequencySpectrum::jonswap(u, fetch),
                            [u, fetch](double w) { return plain_jonswap(w, u, fetch); }});
    }
    return list;
}

TEST(Spectrum, DensitiesAreTheTextbooks) {
    for (const Case& c : cases())
        for (double w = c.spectrum.range().low; w < c.spectrum.range().high; w *= 1.03) {
            const double expected = c.plain(w);
            EXPECT_NEAR(c.spectrum.density(w), expected, 1e-12 * expected + 1e-300) << w;
        }
}

TEST(Spectrum, MomentsAreThePlainSums) {
    for (const Case& c : cases()) {
        const FrequencyRange range = c.spectrum.range();
        for (int n = 0; n <= 2; ++n) {
            const double expected = plain_moment(c.plain, n, range.low, range.high);
            const double value = n == 0 ? c.spectrum.m0() : n == 1 ? c.spectrum.m1() : c.spectrum.m2();
            EXPECT_NEAR(value, expected, 2e-7 * expected)
                << "m" << n << " of spectrum " << static_cast<int>(c.spectrum.kind()) << " at "
                << c.spectrum.wind_speed() << " m/s";
        }
    }
}

TEST(Spectrum, PeakIsWhereTheDensityIsLargest) {
    for (const Case& c : cases()) {
        const double peak = c.spectrum.peak_omega();
        for (const double factor : {0.99, 0.999, 1.001, 1.01})
            EXPECT_LT(c.spectrum.density(peak * factor), c.spectrum.density(peak)) << factor;
    }
}

TEST(Spectrum, CumulativeEnergyIsThePlainSumAndItsInverseInverts) {
    for (const Case& c : cases()) {
        const FrequencyRange range = c.spectrum.range();
        EXPECT_EQ(c.spectrum.cumulative(0.5 * range.low), 0.0);
        EXPECT_EQ(c.spectrum.cumulative(2.0 * range.high), c.spectrum.m0());
        for (const double q : {0.001, 0.1, 0.25, 0.5, 0.75, 0.9, 0.999}) {
            const double w = c.spectrum.quantile(q);
            EXPECT_NEAR(plain_moment(c.plain, 0, range.low, w), q * c.spectrum.m0(), 2e-5 * c.spectrum.m0())
                << q;
            EXPECT_NEAR(c.spectrum.cumulative(w), q * c.spectrum.m0(), 1e-12 * c.spectrum.m0()) << q;
        }
        EXPECT_EQ(c.spectrum.quantile(1.0), range.high);
        double last = 0.0;
        for (int i = 0; i <= 1000; ++i) {
            const double w = c.spectrum.quantile(i / 1000.0);
            EXPECT_GE(w, last);
            last = w;
        }
    }
}

TEST(Spectrum, PiersonMoskowitzHasItsClosedForms) {
    for (const double u : {2.0, 10.0, 20.0, 40.0}) {
        const auto s = FrequencySpectrum::pierson_moskowitz(u);
        EXPECT_EQ(s.wind_height(), 19.5);
        EXPECT_NEAR(s.peak_omega(), 0.877 * gravity / u, 2e-4 * s.peak_omega());
        // E(ω) = α g² / (4 β (g/U)⁴) exp(-β (g/(Uω))⁴)
        const auto energy = [&](double w) {
            const double b = 0.74 * std::pow(gravity / u, 4.0);
            return 0.0081 * gravity * gravity / (4.0 * b) * std::exp(-b * std::pow(w, -4.0));
        };
        const double m0 = energy(s.range().high) - energy(s.range().low);
        EXPECT_NEAR(s.m0(), m0, 1e-9 * m0);
        // Row A2: H = 0.21 h²/g; what lies beyond the used range is at most half a percent of the energy.
        EXPECT_NEAR(s.significant_height() * gravity / (u * u), 0.21, 0.0015) << u;
    }
}

TEST(Spectrum, JonswapGrowsByItsFitsUntilFullDevelopment) {
    // Hs g/U² = 4 √(0.076 I(3.3) / 22⁴) x^(2/3 - 0.11), I = ∫ of the shape with its own peak = 0.30499.
    for (const double x : {100.0, 1000.0, 10'000.0}) {
        const double u = 12.0;
        const auto s = FrequencySpectrum::jonswap(u, x * u * u / gravity);
        EXPECT_EQ(s.wind_height(), 10.0);
        const double height =
            4.0 * std::sqrt(0.076 * 0.30499 / std::pow(22.0, 4.0)) * std::pow(x, 2.0 / 3.0 - 0.11);
        EXPECT_NEAR(s.significant_height() * gravity / (u * u), height, 0.004 * height) << x;
        const double fit = 0.0016 * std::sqrt(x);
        EXPECT_GT(height, 1.01 * fit);
        EXPECT_LT(height, 1.33 * fit);
        EXPECT_NEAR(s.peak_omega(), 22.0 * gravity / u / std::cbrt(x), 1e-12 * s.peak_omega());
    }
    const auto grown = FrequencySpectrum::jonswap(12.0, 300'000.0);
    EXPECT_EQ(grown.m0(), FrequencySpectrum::jonswap(12.0, 900'000.0).m0());
    const auto full =
        FrequencySpectrum::pierson_moskowitz(12.0 * wind_at_height(1.0, 19.5) / wind_at_height(1.0, 10.0));
    EXPECT_NEAR(grown.significant_height(), full.significant_height(), 0.003 * full.significant_height());
    // γ = 1 leaves Pierson and Moskowitz' shape; larger ones only sharpen the peak.
    const auto flat = FrequencySpectrum::jonswap(12.0, 30'000.0, {}, 1.0);
    const auto sharp = FrequencySpectrum::jonswap(12.0, 30'000.0, {}, 7.0);
    EXPECT_NEAR(sharp.density(sharp.peak_omega()) / flat.density(flat.peak_omega()), 7.0, 1e-9);
    EXPECT_NEAR(sharp.density(3.0) / flat.density(3.0), 1.0, 1e-6);
}

TEST(Spectrum, NeumannsHeightIsTheOnePublished) {
    // Pierson, Neumann and James (1955): E = 0.242 (v / 10 kn)^5 ft², H1/3 = 2.83 √E.
    for (const double knots : {20.0, 30.0, 40.0}) {
        const auto s = FrequencySpectrum::neumann(knots * 0.514444, {0.05, 8.0});
        EXPECT_EQ(s.wind_height(), 7.5);
        const double feet = 2.83 * std::sqrt(0.242 * std::pow(knots / 10.0, 5.0));
        EXPECT_NEAR(s.significant_height() / 0.3048, feet, 0.01 * feet) << knots;
        EXPECT_NEAR(s.peak_omega(), std::sqrt(2.0 / 3.0) * gravity / (knots * 0.514444), 1e-12);
    }
}

TEST(Spectrum, RangeIsTheDefaultInStrongWindsAndWidensForLightOnes) {
    const FrequencyRange standard = FrequencySpectrum::pierson_moskowitz(12.0).range();
    EXPECT_EQ(standard, FrequencyRange{});
    const auto light = FrequencySpectrum::pierson_moskowitz(2.0);
    EXPECT_NEAR(light.peak_omega(), 4.3, 0.01);
    EXPECT_EQ(light.range().low, 0.2);
    EXPECT_DOUBLE_EQ(light.range().high, 4.0 * light.peak_omega());
    const double b = 0.74 * std::pow(gravity / 2.0, 4.0);
    EXPECT_GT(light.m0() / (0.0081 * gravity * gravity / (4.0 * b)), 0.995);
    EXPECT_DOUBLE_EQ(FrequencySpectrum::pierson_moskowitz(40.0).range().low,
                     0.5 * FrequencySpectrum::pierson_moskowitz(40.0).peak_omega());
    // The shortest fetch under the lightest wind: ripples of 6 cm, and no wave below 5 cm.
    const auto ripples = wind_spectrum(1.0, to_lattice(32.0));
    EXPECT_LT(ripples.range().high, 37.1);
    EXPECT_GT(2.0 * pi / deep_wave_number(ripples.range().high), 0.0499);
    EXPECT_GT(ripples.m0(), 0.0);
    // As asked, where the asked range is the wider one.
    EXPECT_EQ(FrequencySpectrum::neumann(12.0, {0.1, 6.0}).range(), (FrequencyRange{0.1, 6.0}));
}

TEST(Spectrum, TheFetchDecidesBetweenJonswapAndPiersonMoskowitz) {
    EXPECT_EQ(wind_spectrum(12.0, to_lattice(80'000.0)).kind(), Spectrum::jonswap);
    EXPECT_EQ(wind_spectrum(12.0, to_lattice(400'000.0)).kind(), Spectrum::pierson_moskowitz);
    EXPECT_EQ(wind_spectrum(5.0, to_lattice(80'000.0)).kind(), Spectrum::pierson_moskowitz);
    EXPECT_EQ(wind_spectrum(12.0, to_lattice(80'000.0), Spectrum::neumann).kind(), Spectrum::neumann);
    EXPECT_EQ(wind_spectrum(12.0, to_lattice(80'000.0), Spectrum::pierson_moskowitz).kind(),
              Spectrum::pierson_moskowitz);
    // Each takes the wind at its own height.
    EXPECT_NEAR(wind_spectrum(12.0, to_lattice(80'000.0)).wind_speed(), 12.0 / 1.0602, 1e-3);
    EXPECT_NEAR(wind_spectrum(12.0, to_lattice(80'000.0), Spectrum::neumann).wind_speed(),
                12.0 * 0.97407 / 1.0602, 1e-3);
    EXPECT_EQ(wind_at_height(12.0, 19.5), 12.0);
}

}  // namespace
}  // namespace trochoid
