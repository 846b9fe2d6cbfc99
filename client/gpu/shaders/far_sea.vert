// The sea beyond the patches: a fan around the camera without waves, whose roughness still knows them: envelopes and land, but
// no wave is summed up.
#include "frame.glsl"
#include "spacing.glsl"
#include "displacement.glsl"
uniform vec4 fan;      // yaw of its left side, opening, rad; where it begins and ends, m
uniform ivec2 counts;  // sectors, rings

out SeaVertex {
    vec3 position;
    vec3 normal;
    vec2 rest;
    vec3 waves;
} vertex;

void main() {
    int ring = gl_VertexID / (counts.x + 1);
    float yaw = fan.x + fan.y * float(gl_VertexID - ring * (counts.x + 1)) / float(counts.x);
    // The first ring is where the fan begins, all others follow by equal ratios.
    float first = max(fan.z, 30.0);
    float distance = ring == 0 ? fan.z : first * pow(fan.w / first, float(ring) / float(counts.y));
    ivec2 place = camera_cell.xy + ivec2(round(vec2(sin(yaw), -cos(yaw)) * (distance * 1024.0)));
    displace(0, place, 1e9);
    vertex.position = curved(from_camera(place, 0.0));
    vertex.normal = vec3(0.0, 1.0, 0.0);
    vertex.rest = vec2(place) * lattice_unit;
    vertex.waves = vec3(0.0, faded_variance, total_variance);
    gl_Position = clip_from_camera * vec4(vertex.position, 1.0);
}
