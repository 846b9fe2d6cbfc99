#include "frame.glsl"
#include "sky.glsl"
#include "water.glsl"
in SeaVertex {
    vec3 position;
    vec3 normal;
    vec2 rest;
    vec3 waves;
} vertex;
flat in int patch_level;
out vec4 colour;

void main() { colour = water_colour(vertex.position, vertex.normal, vertex.rest, vertex.waves); }
