// The projected screen grid (projected_mesher.cpp): rows across the line of sight, from the foreground to the horizon.
#include "frame.glsl"
#include "spacing.glsl"
#include "surface.glsl"
#include "patch_directory.glsl"
uniform samplerBuffer projected_rows;  // metres ahead, half of the width (m), spacing (m), 0
uniform vec4 projected_axes;           // unit vectors on the sea: to the right (xy) and ahead (zw)
uniform int projected_columns;         // quads a row

void main() {
    int vertices = projected_columns + 1;
    vec3 row = texelFetch(projected_rows, gl_VertexID / vertices).xyz;
    float across = row.y * (float(2 * (gl_VertexID % vertices)) / float(projected_columns) - 1.0);
    vec2 metres = projected_axes.zw * row.x + projected_axes.xy * across;
    ivec2 place = mesh_cell.xy + ivec2(round(mesh_eye.xy + metres * 1024.0));
    emit_surface(place, list_at(place), max(sea_spacing(place), row.z), 0);
}
