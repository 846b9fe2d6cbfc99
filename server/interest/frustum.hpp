#pragma once
#include <array>

#include "protocol/model/view.hpp"

namespace trochoid {

/// A vector relative to the camera, metres: x east, y up, z south.
struct Vec3 {
    double x = 0.0, y = 0.0, z = 0.0;
    bool operator==(const Vec3&) const = default;
};

/// Inside where normal·p + offset >= 0.
struct Plane {
    Vec3 normal{0.0, 0.0, 0.0};
    double offset = 1.0;  ///< as left: every point is inside
    bool operator==(const Plane&) const = default;
};

/// Left, right, bottom, top, near, far.
using SixPlanes = std::array<Plane, 6>;

/// Where the camera looks, unit length.
Vec3 forward_of(const ViewState& view);

/// The six planes of the view, unit normals, extracted from the combined projection and view matrix after Gribb and
/// Hartmann, "Fast Extraction of Viewing Frustum Planes from the World-View-Projection Matrix" (2001); row A10.
/// Distances in metres, 0 < near < far.
SixPlanes planes_of(const ViewState& view, double near_distance, double far_distance);

/// Planes that hold every frustum whose camera lies within `slack` metres of the view's and is turned against it, about
/// any axis, by an angle of at most this tangent. Lenses so wide that no plane can promise it give planes that hold all.
SixPlanes padded_planes(const ViewState& view, double slack, double tangent, double far_distance);

/// An axis-aligned bounding box around a patch of the surface, metres relative to the camera.
struct SurfaceBounds {
    Vec3 middle;
    Vec3 half;
};

/// True only where the box lies wholly on the outer side of one plane.
bool outside(const SixPlanes& planes, const SurfaceBounds& bounds);

}  // namespace trochoid
