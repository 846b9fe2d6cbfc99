// A hull's vertices, from the hull's own axes to the sea's.
#include "frame.glsl"
layout(location = 0) in vec3 place_in;   // lengths, lengths, beams
layout(location = 1) in vec3 normal_in;
layout(location = 2) in vec4 paint_in;   // albedo, gloss
uniform ivec2 ship_place;  // relative to the anchor, lattice units
uniform mat3 ship_axes;    // towards the bow, up, to starboard
uniform vec3 ship_size;    // length, beam, height of the waterline above still water, m

out ShipVertex {
    vec3 position;
    vec3 normal;
    vec3 hull;  // m from amidships on the waterline, in the hull's axes
    vec4 paint;
} vertex;

void main() {
    vec3 scale = vec3(ship_size.x, ship_size.x, ship_size.y);
    vertex.hull = place_in * scale;
    vertex.position = curved(from_camera(ship_place, ship_size.z) + ship_axes * vertex.hull);
    // Normals are of a hull that is seven times as long as broad.
    float broader = 7.0 * ship_size.y / ship_size.x;
    vertex.normal = ship_axes * normalize(normal_in / vec3(1.0, 1.0, broader));
    vertex.paint = paint_in;
    gl_Position = clip_from_camera * vec4(vertex.position, 1.0);
}
