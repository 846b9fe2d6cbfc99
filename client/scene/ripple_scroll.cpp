#include "client/scene/ripple_scroll.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "client/scene/sea_weather.hpp"

namespace trochoid {

namespace {

// Sides of the tiles, m: ripples.glsl.
constexpr std::array<double, 3> tile_m{1024.0 / 300.0, 1024.0 / 55.0, 1024.0 / 15.0};
// Longer waves run faster; capillary ones never rest.
constexpr std::array<double, 3> share_of_speed{0.35, 0.6, 1.0};
constexpr std::array<double, 3> least_m_s{0.22, 0.12, 0.0};

float fraction(double tiles) { return static_cast<float>(tiles - std::floor(tiles)); }

}  // namespace

void RippleScroll::advance(SeaTime now, float wind_m_s) {
    const double speed = scroll_speed(wind_m_s);
    constexpr double longest_step_s = 10.0;
    const double step = static_cast<double>(now.us - last_.us) / 1e6;
    const bool anew = last_.us < 0 || step < 0.0 || step > longest_step_s;
    const double seconds = anew ? static_cast<double>(now.us) / 1e6 : step;
    for (size_t i = 0; i < tile_m.size(); ++i) {
        const double tiles = seconds * std::max(speed * share_of_speed[i], least_m_s[i]) / tile_m[i];
        tiles_[static_cast<int>(i)] = fraction(anew ? tiles : tiles_[static_cast<int>(i)] + tiles);
    }
    tiles_.w = fraction(anew ? seconds * 0.006 : tiles_.w + seconds * 0.006);
    last_ = now;
}

}  // namespace trochoid
