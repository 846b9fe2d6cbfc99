#include "client/scene/camera.hpp"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

namespace trochoid {

namespace {

/// Tangents of half-angles that a view may state (protocol/model/view.hpp).
constexpr float narrowest_told = 0.01F;
constexpr float widest_told = 20.0F;
constexpr double near_m = 0.3;
constexpr double far_m = 400'000.0;

/// Adds metres to a coordinate kept as whole lattice units and a fraction.
void advance(int64_t& whole, double& fraction, double metres) {
    const double units = fraction + metres * static_cast<double>(lattice_per_metre);
    const double floor = std::floor(units);
    whole = std::clamp(whole + static_cast<int64_t>(floor), -world_bound, world_bound);
    fraction = units - floor;
}

/// Reversed depth with the far plane at infinity: depth = near / distance, so a float's precision is spent evenly.
glm::mat4 reversed_projection(float tan_x, float tan_y) {
    glm::mat4 m(0.0F);
    m[0][0] = 1.0F / tan_x;
    m[1][1] = 1.0F / tan_y;
    m[2][3] = -1.0F;
    m[3][2] = static_cast<float>(near_m);
    return m;
}

float tan_half_height(const Camera& camera) {
    return static_cast<float>(std::tan(camera.vertical_angle / 2));
}
float tan_half_width(const Camera& camera) {
    return tan_half_height(camera) * static_cast<float>(camera.width) / static_cast<float>(camera.height);
}

}  // namespace

void move(Camera& camera, double east_m, double up_m, double south_m) {
    advance(camera.position.x, camera.fraction_x, east_m);
    advance(camera.position.z, camera.fraction_z, south_m);
    camera.altitude_m = std::clamp(camera.altitude_m + up_m, lowest_altitude_m, highest_altitude_m);
}

glm::dvec3 forward_of(const Camera& camera) {
    return {std::sin(camera.yaw) * std::cos(camera.pitch), std::sin(camera.pitch),
            -std::cos(camera.yaw) * std::cos(camera.pitch)};
}

ViewState view_of(const Camera& camera, glm::dvec3 velocity) {
    ViewState view;
    view.position = camera.position;
    view.altitude = static_cast<int32_t>(to_lattice(camera.altitude_m));
    const glm::dquat turn =
        glm::angleAxis(-camera.yaw, glm::dvec3(0, 1, 0)) * glm::angleAxis(camera.pitch, glm::dvec3(1, 0, 0));
    view.qx = static_cast<float>(turn.x);
    view.qy = static_cast<float>(turn.y);
    view.qz = static_cast<float>(turn.z);
    view.qw = static_cast<float>(turn.w);
    // A window may be drawn out to a strip; servers take no wider or narrower view than that.
    view.tan_half_width = std::clamp(tan_half_width(camera), narrowest_told, widest_told);
    view.tan_half_height = std::clamp(tan_half_height(camera), narrowest_told, widest_told);
    view.viewport_width = static_cast<uint16_t>(camera.width);
    view.viewport_height = static_cast<uint16_t>(camera.height);
    view.vx = static_cast<float>(velocity.x);
    view.vy = static_cast<float>(velocity.y);
    view.vz = static_cast<float>(velocity.z);
    return view;
}

CameraFrame frame_of(const Camera& camera, DepthRange range) {
    return frame_of(camera, range,
                    {(camera.position.x >> anchor_log2) << anchor_log2, (camera.position.z >> anchor_log2)
                                                                            << anchor_log2});
}

float radians_per_pixel(const Camera& camera) {
    return 2.0F * tan_half_height(camera) / static_cast<float>(camera.height);
}

CameraFrame frame_of(const Camera& camera, DepthRange range, LatticePoint anchor) {
    CameraFrame frame;
    frame.anchor = anchor;
    frame.cell = {static_cast<int32_t>(camera.position.x - frame.anchor.x),
                  static_cast<int32_t>(camera.position.z - frame.anchor.z)};
    frame.fraction = {static_cast<float>(camera.fraction_x), static_cast<float>(camera.fraction_z)};
    frame.altitude = static_cast<float>(camera.altitude_m);
    const glm::dvec3 forward = forward_of(camera);
    const glm::dvec3 up(-std::sin(camera.yaw) * std::sin(camera.pitch), std::cos(camera.pitch),
                        std::cos(camera.yaw) * std::sin(camera.pitch));
    const glm::mat4 turn(glm::lookAt(glm::dvec3(0), forward, up));
    const float tan_x = tan_half_width(camera);
    const float tan_y = tan_half_height(camera);
    const auto near = static_cast<float>(near_m);
    const glm::mat4 projection = range == DepthRange::reversed_zero_to_one
                                     ? reversed_projection(tan_x, tan_y)
                                     : glm::frustumRH_NO(-tan_x * near, tan_x * near, -tan_y * near,
                                                         tan_y * near, near, static_cast<float>(far_m));
    frame.clip_from_camera = projection * turn;
    frame.camera_from_clip = glm::inverse(frame.clip_from_camera);
    frame.forward = glm::vec3(forward);
    return frame;
}

glm::vec2 metres_from_anchor(const CameraFrame& frame, LatticePoint p) {
    return {static_cast<float>(to_metres(p.x - frame.anchor.x)),
            static_cast<float>(to_metres(p.z - frame.anchor.z))};
}

glm::vec3 metres_from_camera(const CameraFrame& frame, LatticePoint p, double height_m) {
    const double x =
        static_cast<double>(p.x - frame.anchor.x - frame.cell.x) - static_cast<double>(frame.fraction.x);
    const double z =
        static_cast<double>(p.z - frame.anchor.z - frame.cell.y) - static_cast<double>(frame.fraction.y);
    return {static_cast<float>(x / 1024), static_cast<float>(height_m - static_cast<double>(frame.altitude)),
            static_cast<float>(z / 1024)};
}

}  // namespace trochoid
