#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "client/scene/camera.hpp"
#include "client/scene/draw_options.hpp"
#include "client/scene/frustum.hpp"
#include "protocol/model/displayed.hpp"

namespace trochoid {

/// Quads along a side of one GL patch lie between these powers of two; the smaller one can still be halved.
inline constexpr int least_edge_level = 2;
inline constexpr int most_edge_level = 64;
/// Thresholds of rounding log2 to the nearest integer: sqrt(2) * 2^k.
inline constexpr float sqrt_two = 0x1.6a09e6p+0F;
/// Refinement::screen: no edge counts as shorter than this share of its length, however flat it is seen: waves stand up.
inline constexpr float least_foreshortening = 0.5F;
/// Refinement::frustum: metres of vertex spacing a metre outside of the view.
inline constexpr float spacing_outside_view = 0.125F;

/// The eye that the mesh is made for (frozen by F7 while the drawn camera moves on), and how its mesh is refined (row D4).
struct MeshEye {
    glm::ivec2 cell;       ///< whole lattice units relative to the anchor
    glm::vec2 fraction;    ///< lattice units
    float altitude = 0;    ///< m
    DisplayFilter filter;  ///< turns distance into the wanted vertex spacing
    Refinement refinement = Refinement::distance;
    /// Inward normals and offsets (m, from the eye) of the view's sides, moved outwards by what waves can do.
    std::array<glm::vec4, 4> sides{};
    bool operator==(const MeshEye&) const = default;
};
inline MeshEye mesh_eye(const CameraFrame& frame, const DisplayFilter& filter) {
    return {frame.cell, frame.fraction, frame.altitude, filter, Refinement::distance, {}};
}
/// The same with a criterion; `planes` of the same frame, `waves_m` is how far waves may move the surface.
inline MeshEye mesh_eye(const CameraFrame& frame, const DisplayFilter& filter, Refinement refinement,
                        const FrustumPlanes& planes, float waves_m) {
    MeshEye eye{frame.cell, frame.fraction, frame.altitude, filter, refinement, {}};
    std::copy_n(planes.begin(), eye.sides.size(), eye.sides.begin());
    for (glm::vec4& side : eye.sides) side.w += waves_m;
    return eye;
}

/// From the eye to a place of the still water, metres along x and z. Twin of from_mesh_eye in shaders/spacing.glsl: float32,
/// the same order, here and below.
inline glm::vec2 from_mesh_eye(const MeshEye& eye, glm::ivec2 place) {
    return {(static_cast<float>(place.x - eye.cell.x) - eye.fraction.x) * 0x1p-10F,
            (static_cast<float>(place.y - eye.cell.y) - eye.fraction.y) * 0x1p-10F};
}

/// Wanted vertex spacing in metres by the distance alone, at a place of the still water relative to the anchor. Twin of
/// sea_spacing in shaders/spacing.glsl.
inline float spacing_at(const MeshEye& eye, glm::ivec2 place) {
    const glm::vec2 d = from_mesh_eye(eye, place);
    return vertex_spacing(eye.filter, std::sqrt((d.x * d.x + d.y * d.y) + eye.altitude * eye.altitude));
}

/// The same by the criterion in force: outside of the view it grows with the distance from the view. Twin of mesh_spacing.
inline float mesh_spacing_at(const MeshEye& eye, glm::ivec2 place) {
    const float spacing = spacing_at(eye, place);
    if (eye.refinement != Refinement::frustum) return spacing;
    const glm::vec2 d = from_mesh_eye(eye, place);
    float inside = 0.0F;
    for (const glm::vec4& side : eye.sides)
        inside = std::min(inside, (side.x * d.x + side.z * d.y) + (side.w - side.y * eye.altitude));
    return std::max(spacing, -inside * spacing_outside_view);
}

/// Square of an edge's length in metres as the criterion sees it; `edge` in lattice units, `middle` its middle. On the screen it
/// is the part across the line of sight. Twin of mesh_length2.
inline float mesh_length2(const MeshEye& eye, glm::ivec2 middle, glm::ivec2 edge) {
    const float x = static_cast<float>(edge.x) * 0x1p-10F;
    const float z = static_cast<float>(edge.y) * 0x1p-10F;
    const float whole = x * x + z * z;
    if (eye.refinement != Refinement::screen) return whole;
    const glm::vec2 d = from_mesh_eye(eye, middle);
    const float along = x * d.x + z * d.y;
    const float distance2 = (d.x * d.x + d.y * d.y) + eye.altitude * eye.altitude;
    return std::max(whole - along * along / distance2, whole * (least_foreshortening * least_foreshortening));
}

/// Whether the edge between two places is to be split: a pure function of them and the eye, the same from either end, so both
/// triangles at an edge agree. What stays is shorter than two spacings: hypotenuses, whose legs are then as long as the sides
/// of the tessellator's quads may be. `coarser` multiplies the spacing. Twin of edge_wants_split in shaders/coherent.glsl.
inline bool edge_wants_split(const MeshEye& eye, glm::ivec2 a, glm::ivec2 b, float coarser = 1.0F) {
    const glm::ivec2 middle = (a + b) >> 1;
    const float spacing = mesh_spacing_at(eye, middle) * coarser;
    return mesh_length2(eye, middle, b - a) >= 4.0F * (spacing * spacing);
}

/// Segments of an edge that starts at a place and runs `side` lattice units along x (or z): a power of two, a pure
/// function of the edge and the eye, so both patches at an edge agree without knowing each other. Twin of edge_level in
/// shaders/spacing.glsl.
inline int edge_level(const MeshEye& eye, glm::ivec2 start, bool along_x, int side) {
    const int half = side >> 1;
    const glm::ivec2 middle(start.x + (along_x ? half : 0), start.y + (along_x ? 0 : half));
    float length = static_cast<float>(side) * 0x1p-10F;
    if (eye.refinement == Refinement::screen)
        length = std::sqrt(mesh_length2(eye, middle, along_x ? glm::ivec2(side, 0) : glm::ivec2(0, side)));
    const float wanted = length / mesh_spacing_at(eye, middle);
    int level = least_edge_level;
    for (int next = least_edge_level; next < most_edge_level; next *= 2)
        if (wanted >= static_cast<float>(next) * sqrt_two) level = next * 2;
    return level;
}

/// The same where the neighbour across the edge is one quadtree level coarser: its edge, aligned and twice as long,
/// decides, and this one takes half. `anchor_low` are the low 32 bits of the anchor, for the absolute alignment.
inline int halved_edge_level(const MeshEye& eye, glm::uvec2 anchor_low, glm::ivec2 start, bool along_x,
                             int side) {
    glm::ivec2 parent = start;
    const auto bit = static_cast<uint32_t>(side);
    if (along_x && ((anchor_low.x + static_cast<uint32_t>(start.x)) & bit) != 0) parent.x -= side;
    if (!along_x && ((anchor_low.y + static_cast<uint32_t>(start.y)) & bit) != 0) parent.y -= side;
    return edge_level(eye, parent, along_x, side * 2) / 2;
}

}  // namespace trochoid
