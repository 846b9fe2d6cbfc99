// Which corner of which listed triangle of the coherent mesh a vertex is.
uniform isamplerBuffer coherent_triangles;  // RG32I: three corners each (coherent_cull.geom)
uniform ivec2 mesh_origin;                  // relative to the anchor, lattice units
uniform float coarser;                      // of coherent.glsl

/// Relative to the anchor.
ivec2 place_of(int triangle, int corner) {
    return mesh_origin + texelFetch(coherent_triangles, triangle * 3 + corner).xy;
}
ivec2 corner_place() { return mesh_origin + texelFetch(coherent_triangles, gl_VertexID).xy; }
