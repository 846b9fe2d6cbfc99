// The projected screen grid (projected_mesher.cpp): rows across the line of sight, from the foreground to the horizon.
#define UNEVEN_STEPS
#include "frame.glsl"
#include "spacing.glsl"
#include "surface.glsl"
#include "patch_directory.glsl"
uniform samplerBuffer projected_rows;  // ProjectedRow: metres ahead, half of the width, to the next row, widening over that
uniform vec4 projected_axes;           // unit vectors on the sea: to the right (xy) and ahead (zw)
uniform int projected_columns;         // quads a row

/// Twin of least_spacing_share: nearly no wave runs straight enough across longer cells to be worth a look.
const float across_cells = 0.125;

void main() {
    int vertices = projected_columns + 1;
    vec4 row = texelFetch(projected_rows, gl_VertexID / vertices);
    float side = float(2 * (gl_VertexID % vertices)) / float(projected_columns) - 1.0;
    float across = row.y * side;
    vec2 metres = projected_axes.zw * row.x + projected_axes.xy * across;
    ivec2 place = mesh_cell.xy + ivec2(round(mesh_eye.xy + metres * 1024.0));
    float width = 2.0 * row.y / float(projected_columns);
    step_along = projected_axes.zw * row.z + projected_axes.xy * (row.w * side);
    step_across = projected_axes.xy * width;
    float longest = max(row.z, width);
    float wanted = sea_spacing(place);
    least_spacing = max(wanted, longest * across_cells);
    emit_surface(place, list_at(place), max(wanted, longest), 0);
}
