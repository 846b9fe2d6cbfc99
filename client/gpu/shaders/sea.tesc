// Edge levels from the edges alone, so neighbours agree; inside what the quad's middle wants.
#include "frame.glsl"
#include "spacing.glsl"
layout(vertices = 1) out;
in VertexQuad { ivec4 quad; } from_vertex[];
patch out ivec4 quad;

int level_of(int edge_bit, ivec2 start, bool along_x, int side, int coarser) {
    return (coarser & edge_bit) != 0 ? halved_edge_level(start, along_x, side) : edge_level(start, along_x, side);
}

void main() {
    quad = from_vertex[0].quad;
    int side = 1 << (quad.z & 0xff);
    int coarser = (quad.z >> 8) & 0xff;
    int west = level_of(1, quad.xy, false, side, coarser);
    int north = level_of(2, quad.xy, true, side, coarser);
    int east = level_of(4, quad.xy + ivec2(side, 0), false, side, coarser);
    int south = level_of(8, quad.xy + ivec2(0, side), true, side, coarser);
    // u runs along x, v along z: 0 is u = 0, 1 is v = 0, 2 is u = 1, 3 is v = 1.
    gl_TessLevelOuter[0] = float(west);
    gl_TessLevelOuter[1] = float(north);
    gl_TessLevelOuter[2] = float(east);
    gl_TessLevelOuter[3] = float(south);
    gl_TessLevelInner[0] = float(edge_level(quad.xy + ivec2(0, side / 2), true, side));
    gl_TessLevelInner[1] = float(edge_level(quad.xy + ivec2(side / 2, 0), false, side));
}
