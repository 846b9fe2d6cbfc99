#include "client/scene/sea_weather.hpp"

#include <algorithm>
#include <cmath>

#include "client/scene/sea_table.hpp"

namespace trochoid {

namespace {

constexpr float gravity = 9.81F;

float smooth(float low, float high, float v) {
    const float t = std::clamp((v - low) / (high - low), 0.0F, 1.0F);
    return t * t * (3.0F - 2.0F * t);
}

}  // namespace

float wind_of(float significant_height_m, float energy_period_s) {
    if (significant_height_m <= 0.0F || energy_period_s <= 0.0F) return 0.0F;
    constexpr float toba = 0.062F;
    const float period = energy_period_s / 0.9F;  // of the significant waves
    const float friction =
        significant_height_m * significant_height_m / (toba * toba * gravity * period * period * period);
    float wind = friction * 28.0F;
    for (int i = 0; i < 6; ++i) wind = friction / std::sqrt((0.8F + 0.065F * std::min(wind, 40.0F)) * 1e-3F);
    return std::min(wind, 50.0F);
}

float cox_munk_variance(float wind_m_s) { return 0.003F + 0.00512F * wind_m_s; }

float whitecap_share(float wind_m_s) {
    // Below some 3.5 m/s nothing breaks (Monahan and O'Muircheartaigh 1986), which the power law does not know.
    return std::min(2.95e-6F * std::pow(wind_m_s, 3.52F), 0.25F) * smooth(3.0F, 4.5F, wind_m_s);
}

float normal_quantile(float share) {
    // Abramowitz and Stegun 26.2.23, to 4.5e-4.
    const float t = std::sqrt(-2.0F * std::log(std::clamp(share, 1e-6F, 0.5F)));
    return t - (2.515517F + t * (0.802853F + t * 0.010328F)) /
                   (1.0F + t * (1.432788F + t * (0.189269F + t * 0.001308F)));
}

float overcast_of(float wind_m_s) { return 0.96F * smooth(12.0F, 22.0F, wind_m_s); }

float scroll_speed(float wind_m_s) {
    constexpr float base_wind = 3.5F;
    constexpr float factor = 4.0F;
    if (wind_m_s <= base_wind) return 0.0F;
    // Over the first metre a second above the base the growth sets in softly.
    return factor * (std::log(wind_m_s) / std::log(base_wind) - 1.0F) *
           smooth(0.0F, 1.0F, wind_m_s - base_wind);
}

SeaWeather SeaTable::weather_at(LatticePoint p, SeaTime now, float shortest_m) const {
    SeaWeather weather;
    float height_squares = 0.0F;
    for (const Box& box : boxes_) {
        const Envelope e = envelope_at(*box.record, instant_of(*box.record, now), p);
        const float gain = static_cast<float>(e.gain) * 0x1p-24F;
        const float gain2 = gain * gain;
        float energy = 0.0F;
        float period = 0.0F;
        for (size_t i = 0; i < box.constants.size(); ++i) {
            const TrainConstants& c = box.constants[i];
            const float share = 0.5F * c.a * c.a * gain2;
            energy += share;
            period += share * 6.2831853F / std::sqrt(gravity * std::max(c.k, 1e-5F));
            const float slopes = gain2 * box.slope_variance[i];
            weather.heading += glm::vec2(c.dx, c.dz) * slopes;
            weather.slope_variance += slopes;
            const float fold = gain * c.k * std::hypot(c.hx, c.hz);
            if (c.wavelength > shortest_m) weather.fold_variance += 0.5F * fold * fold;
        }
        if (energy <= 0.0F) continue;
        height_squares += 16.0F * energy;
        weather.wind_m_s = std::max(weather.wind_m_s, wind_of(4.0F * std::sqrt(energy), period / energy));
    }
    weather.height_m = std::sqrt(height_squares);
    return weather;
}

}  // namespace trochoid
