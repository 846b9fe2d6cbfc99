#pragma once
#include <array>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "client/scene/camera.hpp"

namespace trochoid {

/// The view's four side planes and the near plane as inward normals and offsets, in metres relative to the camera
/// (Gribb and Hartmann from the combined matrix; the far plane is left out: the sea goes on to the horizon).
using FrustumPlanes = std::array<glm::vec4, 5>;
FrustumPlanes planes_of(const CameraFrame& frame, DepthRange range);

/// Axis-aligned box in metres relative to the camera.
struct Bounds {
    glm::vec3 low;
    glm::vec3 high;
};

/// The box over a square of still water, padded by what waves can move, and let down by the display's curvature.
Bounds bounds_of_square(const CameraFrame& frame, LatticePoint corner, int64_t side, float height_m,
                        float displacement_m);

/// False only where the box is wholly outside one plane.
bool may_see(const FrustumPlanes& planes, const Bounds& bounds);

}  // namespace trochoid
