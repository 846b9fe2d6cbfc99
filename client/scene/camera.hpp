#pragma once
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "protocol/model/view.hpp"
#include "protocol/units/lattice.hpp"

namespace trochoid {

/// Where the viewer stands and looks. Exact anywhere in the world: whole lattice units plus a fraction.
struct Camera {
    LatticePoint position;  ///< lattice units
    double fraction_x = 0;  ///< lattice units in [0, 1), added to the position
    double fraction_z = 0;
    double altitude_m = 20;       ///< above still water
    double yaw = 0;               ///< radians, clockwise from north (-z) seen from above
    double pitch = 0;             ///< radians, positive up, within ±pi/2
    double vertical_angle = 0.9;  ///< full vertical opening angle, radians
    uint32_t width = 1280;        ///< pixels
    uint32_t height = 720;
    bool operator==(const Camera&) const = default;
};

/// How high a camera may stand above still water, metres. From the highest the horizon is 196 km away, within what shaders address.
inline constexpr double lowest_altitude_m = 0.5;
inline constexpr double highest_altitude_m = 3'000.0;
/// Width and height of a picture, pixels: what a view may state (the standard's chapter 10), and the fewest that show anything.
inline constexpr uint32_t fewest_pixels = 16;
inline constexpr uint32_t most_pixels = 16'384;

/// Moves by metres, carrying whole lattice units; held inside the world's bounds and heights.
void move(Camera& camera, double east_m, double up_m, double south_m);

/// Unit vector of the line of sight, x east, y up, z south.
glm::dvec3 forward_of(const Camera& camera);

/// What the server is told of a camera; velocity in m/s.
ViewState view_of(const Camera& camera, glm::dvec3 velocity);

/// Depth mapping of the projection: reversed float depth (1 at the near plane, 0 at infinity) where glClipControl exists,
/// the classic -1..1 range with a far plane otherwise.
enum class DepthRange : uint8_t { reversed_zero_to_one, classic };

/// Alignment of the anchor, log2 lattice units (1024 m): positions in shaders are int32 relative to it, and everything
/// that repeats (ripples, noise) has a period that divides it.
inline constexpr int anchor_log2 = 20;
/// Farthest place from the anchor that shaders address, lattice units along x or z (262 km).
inline constexpr int64_t anchor_reach = int64_t{1} << 28;

/// A camera with all that follows from it, relative to an anchor on the lattice.
struct CameraFrame {
    LatticePoint anchor;         ///< multiple of 2^20, below and near the camera
    glm::ivec2 cell;             ///< camera's whole lattice units relative to the anchor (x, z)
    glm::vec2 fraction;          ///< and the rest, lattice units
    float altitude = 0;          ///< m above still water
    glm::mat4 clip_from_camera;  ///< from metres relative to the camera, axes of the world
    glm::mat4 camera_from_clip;  ///< inverse
    glm::vec3 forward;
    bool operator==(const CameraFrame&) const = default;
};
CameraFrame frame_of(const Camera& camera, DepthRange range);
/// The same relative to the anchor of another camera, within its reach.
CameraFrame frame_of(const Camera& camera, DepthRange range, LatticePoint anchor);

/// Angle of a pixel at the picture's middle.
float radians_per_pixel(const Camera& camera);

/// Metres relative to the anchor, exact to a float's rounding.
glm::vec2 metres_from_anchor(const CameraFrame& frame, LatticePoint p);
/// Metres from the camera to a place of the still water (x, -altitude, z), without curvature.
glm::vec3 metres_from_camera(const CameraFrame& frame, LatticePoint p, double height_m);

}  // namespace trochoid
