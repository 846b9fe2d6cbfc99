#pragma once
#include <glm/vec2.hpp>

namespace trochoid {

/// What the waves at a place say about the wind that raised them; purely visual.
struct SeaWeather {
    glm::vec2 heading{
        0};  ///< where slopes travel (x east, z south), weighted by their variance; not a unit vector
    float wind_m_s = 0;        ///< at 10 m, from height and period of the steepest box
    float height_m = 0;        ///< significant
    float slope_variance = 0;  ///< of all trains, both axes together
    float fold_variance = 0;   ///< of 1 - Jacobian, of the trains longer than a limit
    bool operator==(const SeaWeather&) const = default;
};

/// Wind speed at 10 m that raises waves of a significant height (m) and an energy period (s): Toba's 3/2 power law,
/// Hs = 0.062 (g u*)^1/2 T^3/2, which holds for young and old wind seas alike and makes swell a light wind; drag coefficient by
/// Wu, (0.8 + 0.065 U) / 1000.
float wind_of(float significant_height_m, float energy_period_s);

/// Variance of the slope of a whole sea under a wind, both axes together, without slicks (Cox and Munk 1954).
float cox_munk_variance(float wind_m_s);

/// Share of the sea that whitecaps cover (Monahan and O'Muircheartaigh 1980: 2.95e-6 U^3.52), none below 3 m/s, at most
/// 0.25: beyond, it is streaks and spray.
float whitecap_share(float wind_m_s);

/// The z with a share of a normal distribution above it, 1e-6 <= share <= 0.5.
float normal_quantile(float share);

/// Share of the sky under storm clouds, 0 to 1.
float overcast_of(float wind_m_s);

/// Speed of the far sea's normal map, m/s: A log_a(wind) (paper C, equation 6), less A, so that it begins at 0 at the base wind a
/// and stays there below it.
float scroll_speed(float wind_m_s);

}  // namespace trochoid
