// A vertex of the sea's surface, for every mesher: evaluates it and writes what sea.frag and the probes read.
#include "displacement.glsl"

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
flat out uvec2 probe_trains;
#endif

/// `place` relative to the anchor; `spacing` of the vertices there, m, a function of place and eye alone; `level` of the sea
/// patch, for the debug view, 0 where there is none.
void emit_surface(ivec2 place, int list, float spacing, int level) {
    displace(list, place, spacing);
    vec3 flat_position = from_camera(place, sum_a.y);
    vertex.position = curved(flat_position - vec3(sum_a.x, 0.0, sum_a.z));
    vertex.normal = sea_normal();
    vertex.rest = vec2(place) * lattice_unit;
    vertex.waves = vec3(sum_a.y, faded_variance, total_variance);
    patch_level = level;
    gl_Position = clip_from_camera * vec4(vertex.position, 1.0);
#ifdef TROCHOID_PROBE
    probe_place = place;
    probe_shift = sum_a;
    probe_normal = vertex.normal;
    probe_phases = phase_digest;
    probe_trains = trains_counted;
#endif
}
