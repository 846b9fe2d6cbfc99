#include "client/gpu/frame_uniforms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "protocol/model/displayed.hpp"

namespace trochoid {

namespace {

/// Haze between a camera and the sea, 1/m: sight ends softly at about 35 km; above, the air is clearer.
float haze_at(double altitude_m) {
    constexpr double at_sea_level = 1.0 / 24'000.0;
    constexpr double scale_height_m = 900.0;
    const double heights = std::max(altitude_m / scale_height_m, 1e-3);
    return static_cast<float>(at_sea_level * (1.0 - std::exp(-heights)) / heights);
}

/// Sun, sky and clouds under a weather: an overcast sky lets a fifth of the light through, evenly.
void set_light(FrameUniforms& u, const SkyLight& light, const SeaWeather& weather) {
    const float closed = overcast_of(weather.wind_m_s);
    const float sunlit = 0.32F * std::max(light.towards.y, 0.0F);
    const glm::vec3 level = light.ambient + light.irradiance * sunlit;
    const float grey = glm::dot(level, glm::vec3(0.3F, 0.5F, 0.2F));
    const glm::vec3 clouds = glm::mix(level, grey * glm::vec3(0.90F, 1.0F, 1.10F), 0.8F) * 0.36F;
    u.sun = glm::vec4(light.towards, 0.0F);
    const float through = (1.0F - closed) * (1.0F - closed);
    u.sun_light = {light.irradiance * through, light.exposure * (1.0F + 0.30F * closed)};
    u.sky_ambient = {glm::mix(light.ambient, clouds, closed), light.night};
    u.overcast = {clouds * 1.12F, closed};
}

/// See FrameUniforms::sea_state in frame.glsl.
glm::vec4 sea_state_of(const SeaWeather& weather) {
    const float ripples = std::max(cox_munk_variance(weather.wind_m_s) - weather.slope_variance, 0.0022F);
    const float caps = whitecap_share(weather.wind_m_s);
    return {weather.slope_variance, ripples, caps > 1e-4F ? normal_quantile(caps) : 4.0F,
            std::max(std::sqrt(weather.fold_variance), 0.02F)};
}

}  // namespace

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
    set_light(u, in.light, in.weather);
    u.bed_transform = bed_map_transform(in.bed, frame);
    u.ripple_axes = {ripple_axis(in.ripple_axis), ripple_axis(in.ripple_axis + 1)};
    const double seconds = static_cast<double>(in.now.us) / 1e6;
    u.scroll = in.scroll;
    u.picture = {radians_per_pixel(in.camera), haze_at(in.camera.altitude_m),
                 static_cast<float>(std::fmod(seconds, 4096.0)),
                 static_cast<float>(std::fmod(seconds, 200'000.0) * 0.004)};
    u.foam = {0.6F, 1.1F, in.bed.open_sea_m, in.bed.belt_m};
    u.choice = {static_cast<int>(in.options.displacement), static_cast<int>(in.options.far_method),
                static_cast<int>(eye.refinement), in.options.foam_share ? 1 : 0};
    const float length = glm::length(in.weather.heading);
    u.wind = {length > 1e-6F ? in.weather.heading / length : glm::vec2(1, 0), in.weather.wind_m_s,
              static_cast<float>(in.options.hour)};
    u.mesh_sides = eye.sides;
    u.sea_state = sea_state_of(in.weather);
    u.foam_map_place = in.foam_map_place;
    return u;
}

}  // namespace trochoid
