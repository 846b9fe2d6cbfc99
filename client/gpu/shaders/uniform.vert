// A tile of the uniform grid (uniform_mesher.cpp): places follow from the vertex's number.
#include "frame.glsl"
#include "spacing.glsl"
#include "surface.glsl"
#include "patch_directory.glsl"
uniform ivec4 tile;  // corner relative to the anchor, log2 of a cell (lattice units), vertices a row

void main() {
    ivec2 place = tile.xy + (ivec2(gl_VertexID % tile.w, gl_VertexID / tile.w) << tile.z);
    float cell = float(1 << tile.z) * lattice_unit;
    emit_surface(place, list_at(place), max(sea_spacing(place), cell), 0);
}
