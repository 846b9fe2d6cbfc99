#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "protocol/codec/messages.hpp"

namespace trochoid {

/// Wind speed at `height` metres of a wind of `speed` m/s at 19.5 m, by the logarithmic profile
/// U(z) = U10 (1 + √Cd/κ ln(z/10 m)) with Cd = 1.3e-3 and κ = 0.4: U19.5 = 1.060 U10, U7.5 = 0.974 U10. (Stewart 2008, section
/// 16.4, names the same drag but prints 1.026, which it does not give.)
double wind_at_height(double speed, double height);

/// Frequencies that waves are drawn from, rad/s. The default is paper C's.
struct FrequencyRange {
    double low = 0.2;
    double high = 3.5;
    bool operator==(const FrequencyRange&) const = default;
};

/// The range as it is used for a spectrum with the peak at `peak_omega`: `asked`, widened down to half the peak and up to four
/// times the peak, so that a light wind's and a short fetch's sea keeps 99.5 % of its energy (2 m/s: peak 4.3, up to 17.2 rad/s), but
/// never beyond the frequency of the shortest wave that a scene may write (5 cm, 37 rad/s). From 10 m/s on a fully developed sea
/// uses the default as it stands.
FrequencyRange used_range(FrequencyRange asked, double peak_omega);

/// A frequency spectrum S(ω) of wind waves in m² s: the variance of the height per rad/s, so that its integral m0 is Σ A²/2.
/// Density by + - * / and exponential(), integrals and their inverse from a table over the used range: the same bits everywhere.
class FrequencySpectrum {
public:
    /// Pierson and Moskowitz (1964), wind at 19.5 m: S = α g² ω⁻⁵ exp(-β (g/(U ω))⁴), α = 0.0081, β = 0.74. Fully developed
    /// seas, drawn from winds of 10 to 20 m/s. Hs = 0.2092 U²/g (row A2's 0.21), ωp = 0.877 g/U.
    static FrequencySpectrum pierson_moskowitz(double u19_5, FrequencyRange asked = {});

    /// Hasselmann et al. (1973), JONSWAP, wind at 10 m, with x = g F/U²: S = α g² ω⁻⁵ exp(-5/4 (ωp/ω)⁴) γ^r,
    /// r = exp(-(ω/ωp - 1)²/(2 σ²)), σ = 0.07 up to the peak, 0.09 above; α = 0.076 x^-0.22, ωp = 22 (g/U) x^(-1/3), γ = 3.3
    /// (1 to 10). Drawn from 0.1 < x < 10⁴; the fetch counts up to x = jonswap_full_development, where the sea has
    /// grown to Pierson and Moskowitz' height. Hs = 0.00126 x^0.557 U²/g: the paper's separate fit of the total energy, Hs = 0.0016
    /// √x U²/g, is 2 % lower at x = 100 and 25 % at 10⁴.
    static FrequencySpectrum jonswap(double u10, double fetch_metres, FrequencyRange asked = {},
                                     double gamma = 3.3);

    /// Neumann (1953), fully developed seas, wind read at 7.5 m (the height of ships' anemometers then; Pierson 1964):
    /// A²(ω) = C (π/2) ω⁻⁶ exp(-2 g²/(U ω)²), C = 3.05 m² s⁻⁵. Neumann's A² is the sum of squared amplitudes, E = 2 m0; here
    /// S = A²/2. H1/3 = 2.83 √E = 4 √m0 = 0.00707 U^2.5 (m, m/s), ωp = 0.816 g/U. Drawn from 5 to 20 m/s.
    static FrequencySpectrum neumann(double u7_5, FrequencyRange asked = {});

    Spectrum kind() const { return kind_; }
    /// The wind that it states, m/s, and the height of that wind, m.
    double wind_speed() const { return wind_speed_; }
    double wind_height() const { return wind_height_; }
    double peak_omega() const { return peak_omega_; }
    FrequencyRange range() const { return range_; }

    /// S in m² s at ω > 0 rad/s, also outside the used range.
    double density(double omega) const;
    /// Moments ∫ ωⁿ S dω over the used range: m², m² rad/s, m² rad²/s².
    double m0() const { return energy_.back(); }
    double m1() const { return m1_; }
    double m2() const { return m2_; }
    /// 4 √m0, m.
    double significant_height() const;

    /// Energy between the range's low end and ω, m²: 0 below the range, m0 above; within 2e-5 of m0.
    double cumulative(double omega) const;
    /// Its inverse: the frequency below which the share `quantile` in [0, 1] of m0 lies, of the same accuracy.
    double quantile(double quantile) const;

private:
    /// S = scale ω^-power exp(-decay ω^-steep) γ^r, steep 2 or 4, power 5 or 6.
    struct Form {
        double scale = 0.0;
        int power = 5;
        double decay = 0.0;
        int steep = 4;
        double log_gamma = 0.0;
    };
    FrequencySpectrum(Spectrum kind, double wind_speed, double wind_height, double peak_omega, Form form,
                      FrequencyRange asked);
    void integrate();

    Spectrum kind_;
    double wind_speed_;
    double wind_height_;
    double peak_omega_;
    Form form_;
    FrequencyRange range_;
    double m1_ = 0.0;
    double m2_ = 0.0;
    std::vector<double> omega_;   ///< nodes, rising geometrically
    std::vector<double> energy_;  ///< from range().low to each node
};

/// g F/U10² from which a sea is fully developed: JONSWAP's m0 reaches Pierson and Moskowitz' there, within 0.1 % of Hs.
inline constexpr double jonswap_full_development = 12046.0;

/// The spectrum of a wind of `speed` m/s at 19.5 m over `fetch` lattice units, translated to the height that the spectrum states.
/// `automatic` is JONSWAP below full development and Pierson-Moskowitz from there on.
FrequencySpectrum wind_spectrum(double speed, int64_t fetch, Spectrum spectrum = Spectrum::automatic,
                                FrequencyRange asked = {});

}  // namespace trochoid
