#pragma once
#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/model/view.hpp"

// The displayed surface: what the server's filter, the client's CPU and the shader must agree on (model: "The two
// surfaces"; row B6). Float32 + - * / sqrt only; a shader writes the same expressions.
namespace trochoid {

/// Finest spacing of displayed vertices, metres: waves from 1 m begin to show near the camera, from 2 m in full.
inline constexpr float finest_vertex_spacing = 0.5F;
/// Vertices are this many pixels apart for each pixel of error in force.
inline constexpr float pixels_per_vertex = 2.0F;
/// Patches split until their side takes at most this many vertex spacings (two runs of 48 for a tessellator whose limit
/// is 64).
inline constexpr int patch_segments = 96;
/// A train starts to show where its wavelength is this many vertex spacings, and is whole at the second.
inline constexpr float spacings_of_first_show = 2.0F;
inline constexpr float spacings_of_full_show = 4.0F;
/// Mean radius of the earth, metres (curvature is a display transform).
inline constexpr double earth_radius = 6'371'000.0;

/// Turns a distance into a vertex spacing.
struct DisplayFilter {
    float finest_spacing = finest_vertex_spacing;  ///< m
    float angle_per_vertex = 0.0F;                 ///< vertex spacing over distance, rad
    bool operator==(const DisplayFilter&) const = default;
};

/// angle_per_vertex = error * pixels_per_vertex * angle of a pixel at the picture's middle (2 * tangent / pixels, the
/// smaller of both axes). The default view gives 1/320: a wave of 10 m is whole up to 800 m and gone from 1600 m.
/// `lens` gives tangents and viewport only; the error is the one in force (CullKey::error_in_force_px).
DisplayFilter display_filter(const ViewState& lens, float error_px);

/// Spacing of vertices, metres, at a distance (m) from the camera. The distance is that in three dimensions to the
/// vertex's rest point on flat, still water (y = 0, no curvature): sqrt((dx*dx + dz*dz) + altitude*altitude).
inline float vertex_spacing(const DisplayFilter& filter, float distance) {
    const float by_angle = distance * filter.angle_per_vertex;
    return by_angle > filter.finest_spacing ? by_angle : filter.finest_spacing;
}

/// Share in [0, 1] of a train of this wavelength (m) that is displayed at a vertex spacing (m): exactly 0 up to 2
/// spacings a wave, exactly 1 from 4, t*t*(3 - 2t) between. Displacement and derivatives scale alike.
inline float displayed_weight(float wavelength, float spacing) {
    const float t =
        (wavelength / spacing - spacings_of_first_show) / (spacings_of_full_show - spacings_of_first_show);
    if (t <= 0.0F) return 0.0F;
    if (t >= 1.0F) return 1.0F;
    return t * t * (3.0F - 2.0F * t);
}

/// How far the water is shown, metres along the sea: where the earth's curvature hides waves of `wave_height` (m) from
/// a camera at `altitude` (m; below water counts as 0): sqrt(2 R altitude) + sqrt(2 R wave_height), at least 12 km and
/// at most 60 km.
double visibility_distance(double altitude, double wave_height);

/// Drop of the displayed surface by curvature, metres, at a distance (m) along the sea: d*d / (2 R), 7.8 m at 10 km.
inline double curvature_drop(double distance) { return distance * distance / (2.0 * earth_radius); }

}  // namespace trochoid
