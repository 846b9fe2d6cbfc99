#include "protocol/model/displayed.hpp"

#include <algorithm>
#include <cmath>

namespace trochoid {

DisplayFilter display_filter(const ViewState& lens, float error_px) {
    const float across = 2.0F * lens.tan_half_width / static_cast<float>(lens.viewport_width);
    const float upright = 2.0F * lens.tan_half_height / static_cast<float>(lens.viewport_height);
    return {finest_vertex_spacing, error_px * pixels_per_vertex * std::min(across, upright)};
}

double visibility_distance(double altitude, double wave_height) {
    const double horizon = std::sqrt(2.0 * earth_radius * std::max(altitude, 0.0));
    const double beyond = std::sqrt(2.0 * earth_radius * std::max(wave_height, 0.0));
    return std::clamp(horizon + beyond, 12'000.0, 60'000.0);
}

}  // namespace trochoid
