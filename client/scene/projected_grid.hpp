#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "client/scene/camera.hpp"
#include "client/scene/draw_options.hpp"
#include "client/scene/sea_table.hpp"

namespace trochoid {

/// What a projected grid is laid out for (paper B, section 4.1). The camera does not roll.
struct ProjectedView {
    double altitude_m = 20;         ///< above still water, > 0
    double pitch = 0;               ///< radians, positive up, within ±pi/2
    double tan_half_width = 0.86;   ///< of the picture
    double tan_half_height = 0.48;  ///< of the picture
    glm::vec2 right{1, 0};     ///< unit vectors on the sea (x east, z south): to the right in the picture,
    glm::vec2 forward{0, -1};  ///< and ahead
    bool operator==(const ProjectedView&) const = default;
};
ProjectedView projected_view(const CameraFrame& frame);

/// Quads along the picture's height and width.
struct ProjectedShape {
    uint32_t rows = 0;
    uint32_t columns = 0;
    bool operator==(const ProjectedShape&) const = default;
};
inline constexpr uint32_t most_projected_quads = 512;
/// As the options say, or from the wanted angle between vertices: columns are so far apart, rows six times closer, since seen
/// from near the water a quad is far longer than wide.
ProjectedShape projected_shape(const DrawOptions& options, const ProjectedView& view, float angle_per_vertex);

/// A row of vertices: a straight line on the still water, across the line of sight.
struct ProjectedRow {
    float forward = 0;     ///< metres ahead of the camera; behind it < 0
    float half_width = 0;  ///< metres to either side
    float along = 0;       ///< metres to the next row, the farther of two
    float widening = 0;    ///< metres by which half_width grows over `along`
    bool operator==(const ProjectedRow&) const = default;
};

struct ProjectedGrid {
    std::vector<ProjectedRow> rows;  ///< by distance, nearest first; empty where no water can be in view
    uint32_t columns = 0;            ///< quads a row
    bool operator==(const ProjectedGrid&) const = default;
};

/// How the vertices of a mesh lie about one of them: metres along x and z to the next ones. Cells may be far longer than wide.
struct VertexSteps {
    glm::vec2 along{0};
    glm::vec2 across{0};
};
/// No wave counts as sampled finer than by this share of the longest step: nearly none runs straight enough across longer cells.
inline constexpr float least_spacing_share = 0.125F;
VertexSteps steps_at(const ProjectedView& view, const ProjectedGrid& grid, size_t row, uint32_t column);

/// Spacing, m, that a wave with this wave vector (rad/m) and length (m) is filtered by: as far as vertices are apart along its own
/// direction, so that waves which run across long cells stay; at least `least`, m. Where cells are square it is their side. Twin of
/// wave_spacing in shaders/spacing.glsl.
float wave_spacing(const VertexSteps& steps, glm::vec2 k, float wavelength, float least);

/// Rows that cover equal heights of the picture, of the water at rest near the camera and of crests and troughs where these hide
/// it, as far as the curved horizon and beyond it as far as
/// waves rise above it. `attention` > 1 moves rows to the foreground, < 1 to the background. The grid goes beyond the picture by what
/// waves can move, so that no displaced wave leaves a hole, and no row is nearer to the next than half the finest spacing that
/// shows waves. All is continuous in the view: a small motion of the camera moves each vertex by little.
ProjectedGrid make_projected_grid(const ProjectedView& view, const WaveBounds& waves, ProjectedShape shape,
                                  double attention);

}  // namespace trochoid
