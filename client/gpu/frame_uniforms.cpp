#include "client/gpu/frame_uniforms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "protocol/model/displayed.hpp"

namespace trochoid {

namespace {

/// Ripples travel in tiles per second; the fraction of a tile is taken in double, so they never freeze.
float travelled(double seconds, double tiles_per_second) {
    const double tiles = seconds * tiles_per_second;
    return static_cast<float>(tiles - std::floor(tiles));
}

/// Haze between a camera and the sea, 1/m: sight ends softly at about 35 km; above, the air is clearer.
float haze_at(double altitude_m) {
    constexpr double at_sea_level = 1.0 / 24'000.0;
    constexpr double scale_height_m = 900.0;
    const double heights = std::max(altitude_m / scale_height_m, 1e-3);
    return static_cast<float>(at_sea_level * (1.0 - std::exp(-heights)) / heights);
}

}  // namespace

glm::vec3 sun_direction() {
    const double up = 0.42;       // radians above the horizon
    const double towards = 4.22;  // radians clockwise from north
    return {std::sin(towards) * std::cos(up), std::sin(up), -std::cos(towards) * std::cos(up)};
}

glm::vec2 ripple_axis(int number) {
    constexpr std::array<glm::vec2, 3> first{glm::vec2(1.0F, 0.0F), glm::vec2(0.8F, 0.6F),
                                             glm::vec2(0.6F, 0.8F)};
    glm::vec2 axis = first[static_cast<size_t>(number % 3)];
    for (int quarter = 0; quarter < number / 3 % 4; ++quarter) axis = {-axis.y, axis.x};
    return axis;
}

int ripple_axis_near(glm::vec2 heading, int current) {
    const float length = glm::length(heading);
    // Half a step of 30 degrees and a third more: no flickering between two.
    if (length < 1e-6F || glm::dot(heading, ripple_axis(current)) > length * 0.94F) return current;
    int best = 0;
    for (int i = 1; i < 12; ++i)
        if (glm::dot(heading, ripple_axis(i)) > glm::dot(heading, ripple_axis(best))) best = i;
    return best;
}

FrameUniforms make_uniforms(const FrameInputs& in) {
    const CameraFrame& frame = in.frame;
    const MeshEye& eye = in.eye;
    FrameUniforms u;
    u.clip_from_camera = frame.clip_from_camera;
    u.camera_from_clip = frame.camera_from_clip;
    const auto low = [](int64_t v) {
        return static_cast<int32_t>(static_cast<uint32_t>(static_cast<uint64_t>(v)));
    };
    u.camera_cell = {frame.cell, low(frame.anchor.x), low(frame.anchor.z)};
    u.camera_eye = {frame.fraction, frame.altitude, static_cast<float>(0.5 / earth_radius)};
    u.mesh_cell = {eye.cell, in.options.layers.bits, 0};
    u.mesh_eye = {eye.fraction, eye.altitude, 0.0F};
    u.mesh_filter = {eye.filter.finest_spacing, eye.filter.angle_per_vertex,
                     in.options.authoritative ? 1.0F : 0.0F, 0.0F};
    u.sun = glm::vec4(sun_direction(), 0.0F);
    u.bed_transform = bed_map_transform(in.bed, frame);
    u.ripple_axes = {ripple_axis(in.ripple_axis), ripple_axis(in.ripple_axis + 1)};
    const double seconds = static_cast<double>(in.now.us) / 1e6;
    // About the speeds of waves a fifth as long as the tiles.
    u.scroll = {travelled(seconds, 0.26), travelled(seconds, 0.13), travelled(seconds, 0.068),
                travelled(seconds, 0.013)};
    u.picture = {radians_per_pixel(in.camera), haze_at(in.camera.altitude_m),
                 static_cast<float>(std::fmod(seconds, 4096.0)),
                 static_cast<float>(std::fmod(seconds, 200'000.0) * 0.004)};
    u.foam = {0.6F, 1.1F, in.bed.open_sea_m, in.bed.belt_m};
    u.choice = {static_cast<int>(in.options.displacement), static_cast<int>(in.options.far_method),
                static_cast<int>(in.options.refinement), 0};
    const float length = glm::length(in.heading);
    u.wind = {length > 1e-6F ? in.heading / length : glm::vec2(1, 0), 0.0F,
              static_cast<float>(in.options.hour)};
    return u;
}

}  // namespace trochoid
