#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>

#include "client/scene/camera.hpp"
#include "protocol/model/displayed.hpp"

namespace trochoid {

/// Quads along a side of one GL patch lie between these powers of two; the smaller one can still be halved.
inline constexpr int least_edge_level = 2;
inline constexpr int most_edge_level = 64;
/// Thresholds of rounding log2 to the nearest integer: sqrt(2) * 2^k.
inline constexpr float sqrt_two = 0x1.6a09e6p+0F;

/// The eye that the mesh is made for (frozen by F7 while the drawn camera moves on).
struct MeshEye {
    glm::ivec2 cell;       ///< whole lattice units relative to the anchor
    glm::vec2 fraction;    ///< lattice units
    float altitude = 0;    ///< m
    DisplayFilter filter;  ///< turns distance into the wanted vertex spacing
    bool operator==(const MeshEye&) const = default;
};
inline MeshEye mesh_eye(const CameraFrame& frame, const DisplayFilter& filter) {
    return {frame.cell, frame.fraction, frame.altitude, filter};
}

/// Wanted vertex spacing in metres at a place of the still water, relative to the anchor. Twin of sea_spacing in
/// shaders/spacing.glsl: float32, the same order.
inline float spacing_at(const MeshEye& eye, glm::ivec2 place) {
    const float dx = (static_cast<float>(place.x - eye.cell.x) - eye.fraction.x) * 0x1p-10F;
    const float dz = (static_cast<float>(place.y - eye.cell.y) - eye.fraction.y) * 0x1p-10F;
    return vertex_spacing(eye.filter, std::sqrt((dx * dx + dz * dz) + eye.altitude * eye.altitude));
}

/// Segments of an edge that starts at a place and runs `side` lattice units along x (or z): a power of two, a pure
/// function of the edge and the eye, so both patches at an edge agree without knowing each other. Twin of edge_level in
/// shaders/spacing.glsl.
inline int edge_level(const MeshEye& eye, glm::ivec2 start, bool along_x, int side) {
    const int half = side >> 1;
    const glm::ivec2 middle(start.x + (along_x ? half : 0), start.y + (along_x ? 0 : half));
    const float wanted = (static_cast<float>(side) * 0x1p-10F) / spacing_at(eye, middle);
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
