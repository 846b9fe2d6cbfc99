// Evaluates the sea at each vertex of the mesh, a lattice point.
#include "frame.glsl"
#include "spacing.glsl"
#include "surface.glsl"
layout(quads, equal_spacing, cw) in;
patch in ivec4 quad;

void main() {
    // Levels are powers of two up to 64, so the coordinates are exact 64ths.
    ivec2 step = ivec2(gl_TessCoord.xy * 64.0 + 0.5);
    ivec2 place = quad.xy + (step << ((quad.z & 0xff) - 6));
    emit_surface(place, quad.w, shown_spacing(place), quad.z >> 16);
}
