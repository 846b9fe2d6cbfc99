// A terrain tile's vertices: heights from the buffer, places from the vertex's number.
#include "frame.glsl"
layout(location = 0) in ivec2 height_and_skirt;
layout(location = 1) in vec3 normal_in;
uniform ivec4 tile;          // origin relative to the anchor (x, z), log2 of the spacing (lattice units), skirt, m
uniform float height_unit;   // m a count

out LandVertex {
    vec3 position;
    vec3 normal;
    vec3 place;  // metres from the anchor, y = height above still water
} vertex;

const int samples = 65;

ivec2 node_of(int number) {
    if (number < samples * samples) return ivec2(number % samples, number / samples);
    int border = (number - samples * samples) / samples;
    int along = (number - samples * samples) % samples;
    if (border < 2) return ivec2(along, border * (samples - 1));
    return ivec2((border - 2) * (samples - 1), along);
}

void main() {
    ivec2 place = tile.xy + (node_of(gl_VertexID) << tile.z);
    float height = float(height_and_skirt.x) * height_unit;
    vertex.position = curved(from_camera(place, height - float(height_and_skirt.y * tile.w)));
    vertex.normal = normal_in;
    vertex.place = vec3(float(place.x) * lattice_unit, height, float(place.y) * lattice_unit);
    gl_Position = clip_from_camera * vec4(vertex.position, 1.0);
}
