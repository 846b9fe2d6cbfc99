// Debug lines and points: metres from the anchor, drawn in place.
#include "frame.glsl"
layout(location = 0) in vec3 place;
layout(location = 1) in vec4 tint;
out vec4 line_tint;

void main() {
    vec2 camera = (vec2(camera_cell.xy) + camera_eye.xy) * lattice_unit;
    vec3 p = curved(vec3(place.x - camera.x, place.y - camera_eye.z, place.z - camera.y));
    line_tint = tint;
    gl_PointSize = 7.0;
    gl_Position = clip_from_camera * vec4(p, 1.0);
}
