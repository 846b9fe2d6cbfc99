#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "client/scene/camera.hpp"
#include "client/scene/draw_options.hpp"
#include "client/scene/scene_input.hpp"
#include "client/scene/sea_mesh.hpp"

namespace trochoid {

using Tint = std::array<uint8_t, 4>;  // red, green, blue, opacity

/// A debug vertex: metres from the anchor (x, z) and above still water (y).
struct LineVertex {
    float x = 0;
    float y = 0;
    float z = 0;
    Tint tint{255, 255, 255, 255};
};

struct DebugLines {
    std::vector<LineVertex> lines;  ///< pairs
    std::vector<LineVertex> points;
    std::vector<LineVertex> triangles;  ///< triples
};

/// Outlines, rays, action points and fields as the options ask for (row A15).
DebugLines make_debug_lines(const SceneInput& input, const InterestState& state, const CameraFrame& frame,
                            const SeaMesh& mesh, const DrawOptions& options);

/// Colours of the legend.
Tint tint_of(ActionKind kind);
Tint tint_of_level(uint8_t patch_level);

}  // namespace trochoid
