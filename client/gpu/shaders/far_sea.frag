#include "frame.glsl"
#include "sky.glsl"
#include "water.glsl"
in SeaVertex {
    vec3 position;
    vec3 normal;
    vec2 rest;
    vec3 waves;
} vertex;
out vec4 colour;

void main() { colour = vec4(water_colour(vertex.position, vertex.normal, vertex.rest, vertex.waves).rgb, 1.0); }
