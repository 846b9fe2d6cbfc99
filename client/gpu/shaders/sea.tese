// Evaluates the sea at each vertex of the mesh, a lattice point.
#include "frame.glsl"
#include "spacing.glsl"
#include "sea.glsl"
layout(quads, equal_spacing, cw) in;
patch in ivec4 quad;

out SeaVertex {
    vec3 position;  // metres from the camera, with curvature
    vec3 normal;    // unnormalised
    vec2 rest;      // metres from the anchor
    vec3 waves;     // height, m; slope variance not displayed; of the whole sea
} vertex;
flat out int patch_level;
#ifdef TROCHOID_PROBE
flat out ivec2 probe_place;
flat out vec3 probe_shift;
flat out vec3 probe_normal;
flat out uint probe_phases;
#endif

void main() {
    // Levels are powers of two up to 64, so the coordinates are exact 64ths.
    ivec2 step = ivec2(gl_TessCoord.xy * 64.0 + 0.5);
    ivec2 place = quad.xy + (step << ((quad.z & 0xff) - 6));
    sum_sea(quad.w, place, sea_spacing(place));
    vec3 flat_position = from_camera(place, sum_a.y);
    vertex.position = curved(flat_position - vec3(sum_a.x, 0.0, sum_a.z));
    vertex.normal = sea_normal();
    vertex.rest = vec2(place) * lattice_unit;
    vertex.waves = vec3(sum_a.y, faded_variance, total_variance);
    patch_level = quad.z >> 16;
    gl_Position = clip_from_camera * vec4(vertex.position, 1.0);
#ifdef TROCHOID_PROBE
    probe_place = place;
    probe_shift = sum_a;
    probe_normal = vertex.normal;
    probe_phases = phase_digest;
#endif
}
