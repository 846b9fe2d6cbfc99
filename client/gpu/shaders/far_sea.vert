// The sea beyond the patches: a disc around the camera without waves, whose roughness still knows them.
#include "frame.glsl"
#include "spacing.glsl"
#include "sea.glsl"
layout(location = 0) in vec2 polar;  // metres from the camera, radians

out SeaVertex {
    vec3 position;
    vec3 normal;
    vec2 rest;
    vec3 waves;
} vertex;

void main() {
    ivec2 place = camera_cell.xy + ivec2(round(vec2(sin(polar.y), -cos(polar.y)) * (polar.x * 1024.0)));
    sum_sea(0, place, 1e9);
    vertex.position = curved(from_camera(place, 0.0));
    vertex.normal = vec3(0.0, 1.0, 0.0);
    vertex.rest = vec2(place) * lattice_unit;
    vertex.waves = vec3(0.0, faded_variance, total_variance);
    gl_Position = clip_from_camera * vec4(vertex.position, 1.0);
}
