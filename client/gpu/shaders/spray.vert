// A puff of spray: texel of the foam map and number follow from the vertex's number, the rest from the texel's age.
#include "frame.glsl"
#include "noise.glsl"
uniform sampler2D foam_map;
uniform vec2 spray;  // texels a side of the map, height of the picture in pixels
out vec4 puff;       // opacity, a chance; age as a share of its life; 0
out vec3 from_eye;   // m

const float life = 2.0;
const int droplets = 4;

void main() {
    int side = int(spray.x);
    int texel_number = gl_VertexID / droplets;
    int number = gl_VertexID - texel_number * droplets;
    ivec2 texel = ivec2(texel_number & (side - 1), texel_number / side);
    vec4 born = texelFetch(foam_map, texel, 0);
    gl_PointSize = 1.0;
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    puff = vec4(0.0);
    from_eye = vec3(0.0);
    float chance = hash(texel * 3 + ivec2(number * 71, int(born.a * 251.0)));
    float other = hash(texel * 5 + ivec2(int(born.a * 509.0), number * 37));
    float age = born.g + foam_map_place.w - 0.5 * chance * float(number);
    float windy = smoothstep(12.0, 24.0, wind.z);
    // Not every breaking crest throws spray.
    if (age < 0.0 || age > life || born.a > 0.35 + 0.55 * windy) return;
    float texel_m = foam_map_place.z / float(side);
    ivec2 first = ivec2(floor(foam_map_place.xy / texel_m + 0.5)) - side / 2;
    ivec2 index = first + ((texel - first) & (side - 1));
    vec2 at = (vec2(index) + vec2(chance, other)) * texel_m;
    vec2 across = vec2(-wind.y, wind.x);
    float thrown = 1.2 + 3.4 * other * windy;
    float way = wind.z * (0.40 + 0.35 * chance) * age;
    at += wind.xy * way + across * ((other - 0.5) * 1.6 * age);
    float height = born.b + 0.1 + thrown * age - 1.9 * age * age;
    vec2 camera = (vec2(camera_cell.xy) + camera_eye.xy) * lattice_unit;
    from_eye = curved(vec3(at.x - camera.x, height - camera_eye.z, at.y - camera.y));
    float distance = length(from_eye);
    float size = (0.4 + 1.4 * age) * (0.6 + 0.8 * chance);
    float pixels = size / (distance * picture.x);
    gl_PointSize = clamp(pixels, 1.0, 0.16 * spray.y);
    float grown = age / life;
    float opacity = windy * 0.55 * (1.0 - grown) * (1.0 - grown) * smoothstep(0.0, 0.08, grown) * (0.4 + 0.6 * other);
    // Nothing flies into the lens.
    opacity *= min(pixels * pixels, 1.0) * smoothstep(2.0, 9.0, distance) * (1.0 - smoothstep(90.0, 130.0, distance));
    puff = vec4(opacity, chance, grown, 0.0);
    if (opacity > 0.002) gl_Position = clip_from_camera * vec4(from_eye, 1.0);
}
