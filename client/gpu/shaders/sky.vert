// One triangle over the whole picture, at the depth of infinity.
#include "frame.glsl"
out vec3 direction;

void main() {
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    // Any point before the camera gives the direction; SKY_DEPTH is where the depth range ends.
    vec4 p = camera_from_clip * vec4(corner, 0.5, 1.0);
    direction = p.xyz / p.w;
    gl_Position = vec4(corner, SKY_DEPTH, 1.0);
}
