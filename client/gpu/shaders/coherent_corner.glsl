// Which corner of which triangle of the coherent mesh a vertex is. Needs frame.glsl.
uniform isamplerBuffer coherent_triangles;  // RG32I: three corners, I, P of each (coherent_tree.hpp)
uniform ivec2 mesh_origin;                  // relative to the anchor, lattice units
uniform float coarser;                      // of coherent.glsl

/// Relative to the anchor.
ivec2 place_of(int triangle, int corner) {
    return mesh_origin + texelFetch(coherent_triangles, triangle * 5 + corner).xy;
}
ivec2 corner_place() { return place_of(gl_VertexID / 3, gl_VertexID % 3); }

/// Whether a sphere about the triangle at rest lies outside of one side of the view; waves are in the sides' offsets.
/// `height` is how far the surface may rise or fall beyond them, m.
bool out_of_view(float height) {
    int triangle = gl_VertexID / 3;
    ivec2 a = place_of(triangle, 0);
    ivec2 b = place_of(triangle, 1);
    ivec2 c = place_of(triangle, 2);
    vec2 low = vec2(min(min(a, b), c) - mesh_cell.xy) * lattice_unit;
    vec2 high = vec2(max(max(a, b), c) - mesh_cell.xy) * lattice_unit;
    vec2 middle = 0.5 * (low + high);
    // The display's curvature lets it down; a large triangle's far corner by more than its middle.
    float drop = dot(middle, middle) * camera_eye.w;
    float radius = 0.5 * distance(low, high) + height + 1.5 * drop + 0.01;
    vec3 centre = vec3(middle.x, -mesh_eye.z, middle.y);
    for (int i = 0; i < 4; ++i)
        if (dot(mesh_sides[i].xyz, centre) + mesh_sides[i].w < -radius) return true;
    return false;
}

/// All corners of a triangle in one place outside of the picture.
void leave_out() { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); }
