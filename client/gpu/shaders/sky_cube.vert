// One triangle over a face of the sky's cube map.
uniform int face;
out vec3 direction;

void main() {
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    float s = corner.x;
    float t = corner.y;
    if (face == 0) direction = vec3(1.0, -t, -s);
    else if (face == 1) direction = vec3(-1.0, -t, s);
    else if (face == 2) direction = vec3(s, 1.0, t);
    else if (face == 3) direction = vec3(s, -1.0, -t);
    else if (face == 4) direction = vec3(s, -t, 1.0);
    else direction = vec3(-s, -t, -1.0);
    gl_Position = vec4(corner, 0.5, 1.0);
}
