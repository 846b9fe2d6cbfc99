// Lists the triangles of the coherent mesh that the view may see: corners only.
#include "frame.glsl"
layout(points) in;
layout(points, max_vertices = 1) out;
in Record {
    ivec3 x;
    ivec3 z;
    uvec2 identity;
    uvec2 path;
} record[];
out ivec2 corner_a;
out ivec2 corner_b;
out ivec2 corner_c;
uniform ivec2 mesh_origin;  // relative to the anchor, lattice units
uniform vec4 planes[5];     // of the view: inward normal and offset, m from the eye; moved outwards by as far as the surface may move

int least(ivec3 v) { return min(min(v.x, v.y), v.z); }
int greatest(ivec3 v) { return max(max(v.x, v.y), v.z); }

/// Whether a sphere about the triangle at rest lies outside of one plane of the view.
bool out_of_view(ivec3 x, ivec3 z) {
    ivec2 eye = mesh_cell.xy - mesh_origin;
    vec2 low = vec2(ivec2(least(x), least(z)) - eye) * lattice_unit;
    vec2 high = vec2(ivec2(greatest(x), greatest(z)) - eye) * lattice_unit;
    vec2 middle = 0.5 * (low + high);
    // The display's curvature lets it down; a large triangle's far corner by more than its middle.
    float radius = 0.5 * distance(low, high) + 1.5 * dot(middle, middle) * camera_eye.w + 0.01;
    vec3 centre = vec3(middle.x, -mesh_eye.z, middle.y);
    for (int i = 0; i < 5; ++i)
        if (dot(planes[i].xyz, centre) + planes[i].w < -radius) return true;
    return false;
}

void main() {
    ivec3 x = record[0].x;
    ivec3 z = record[0].z;
    if (out_of_view(x, z)) return;
    corner_a = ivec2(x.x, z.x);
    corner_b = ivec2(x.y, z.y);
    corner_c = ivec2(x.z, z.z);
    EmitVertex();
    EndPrimitive();
}
