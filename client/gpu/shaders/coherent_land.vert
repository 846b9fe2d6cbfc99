// A corner of a triangle of the coherent mesh on land (row D9): its height is the bed map's, averaged over the wanted spacing,
// so that hills do not jump where the mesh is refined.
#include "frame.glsl"
#include "spacing.glsl"
#include "bed_height.glsl"
#include "coherent_corner.glsl"
uniform float cell;  // of the bed map, m

out LandVertex {
    vec3 position;
    vec3 normal;
    vec3 place;  // metres from the anchor, y = height above still water
} vertex;

const float hidden_depth = -12.0;  // deeper ground is not seen through the water

void main() {
    int triangle = gl_VertexID / 3;
    bool seen = false;
    for (int k = 0; k < 3; ++k) seen = seen || bed_at(vec2(place_of(triangle, k)) * lattice_unit).x > hidden_depth;
    if (!seen) {
        // All corners in one place outside of the picture.
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
        return;
    }
    ivec2 place = corner_place();
    vec2 rest = vec2(place) * lattice_unit;
    float spacing = shown_spacing(place) * coarser;
    float step = max(0.5 * spacing, cell);
    float east = bed_at(rest + vec2(step, 0.0)).x;
    float west = bed_at(rest - vec2(step, 0.0)).x;
    float south = bed_at(rest + vec2(0.0, step)).x;
    float north = bed_at(rest - vec2(0.0, step)).x;
    float height = bed_at(rest).x;
    height = mix(height, 0.25 * ((east + west) + (south + north)), 0.66 * smoothstep(cell, 4.0 * cell, spacing));
    vertex.position = curved(from_camera(place, height));
    vertex.normal = vec3(west - east, 2.0 * step, north - south);
    vertex.place = vec3(rest.x, height, rest.y);
    gl_Position = clip_from_camera * vec4(vertex.position, 1.0);
}
