// A tile of the uniform grid (uniform_mesher.cpp): places follow from the vertex's number.
#include "frame.glsl"
#include "spacing.glsl"
#include "surface.glsl"
#include "patch_directory.glsl"
layout(location = 0) in ivec2 corner;  // of the tile, relative to the anchor
uniform ivec2 grid_shape;              // log2 of a cell (lattice units), vertices a row of a tile
uniform vec2 grid_edge;  // metres from the eye, along x or z, where waves begin to fade; 1 / metres from there to none

/// Towards the grid's edge waves fade as they do with distance, the short ones first, so that it lies as flat as the sea beyond.
float spacing_towards_edge(ivec2 place, float cell) {
    vec2 away = abs((vec2(place - mesh_cell.xy) - mesh_eye.xy) * lattice_unit);
    float left = clamp(1.0 - (max(away.x, away.y) - grid_edge.x) * grid_edge.y, 0.0, 1.0);
    return cell / max(left * left * left, 1e-6);
}

void main() {
    ivec2 place = corner + (ivec2(gl_VertexID % grid_shape.y, gl_VertexID / grid_shape.y) << grid_shape.x);
    float cell = float(1 << grid_shape.x) * lattice_unit;
    emit_surface(place, list_at(place), max(sea_spacing(place), spacing_towards_edge(place, cell)), 0);
}
