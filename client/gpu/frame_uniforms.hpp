#pragma once
#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include "client/scene/bed_map.hpp"
#include "client/scene/camera.hpp"
#include "client/scene/draw_options.hpp"
#include "client/scene/edge_level.hpp"
#include "client/scene/sea_weather.hpp"
#include "client/scene/sky_model.hpp"
#include "protocol/model/sea.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// The Frame block of shaders/frame.glsl (std140: sixteen-byte members only).
struct FrameUniforms {
    glm::mat4 clip_from_camera{1};
    glm::mat4 camera_from_clip{1};
    glm::ivec4 camera_cell{0};
    glm::vec4 camera_eye{0};
    glm::ivec4 mesh_cell{0};
    glm::vec4 mesh_eye{0};
    glm::vec4 mesh_filter{0};
    glm::vec4 sun{0};
    glm::vec4 bed_transform{0};
    glm::vec4 ripple_axes{1, 0, 1, 0};
    glm::vec4 scroll{0};
    glm::vec4 picture{0};
    glm::vec4 foam{0};
    glm::ivec4 choice{0};
    glm::vec4 wind{1, 0, 0, 12};
    std::array<glm::vec4, 4> mesh_sides{};
    glm::vec4 sun_light{0};
    glm::vec4 sky_ambient{0};
    glm::vec4 overcast{0};
    glm::vec4 sea_state{0, 0, 4, 1};
    glm::vec4 foam_map_place{0};
};

/// What a frame's uniforms follow from.
struct FrameInputs {
    const Camera& camera;
    const CameraFrame& frame;
    const MeshEye& eye;
    const BedMap& bed;
    SeaTime now;
    int ripple_axis = 0;  ///< see ripple_axis_near
    DrawOptions options;  ///< layers, methods and the like
    SkyLight light{};
    SeaWeather weather{};
    glm::vec4 scroll{0};          ///< RippleScroll::tiles
    glm::vec4 foam_map_place{0};  ///< FoamPass::place
};
FrameUniforms make_uniforms(const FrameInputs& inputs);

/// The twelve directions that ripples can travel in, by number: those of 3-4-5 triangles and the axes, clockwise from east.
glm::vec2 ripple_axis(int number);
/// Number of the direction nearest to a heading; keeps `current` where the heading has not turned far from it.
int ripple_axis_near(glm::vec2 heading, int current);

}  // namespace trochoid
