// The bed as it is seen through the water.
#include "bed_height.glsl"

const vec3 extinction = vec3(0.44, 0.105, 0.095);  // 1/m, clear coastal water
const vec3 sand_below = vec3(0.37, 0.34, 0.26);
const vec3 weed_below = vec3(0.10, 0.12, 0.07);

/// Bright lines that ripples draw on the bed.
float caustics(vec2 p, float depth, float pixel) {
    float level = max(1.0 + 0.4 * depth, pixel + 5.6);
    float a = textureLod(ripple_map, p / 5.12 + scroll.xw, level).w;
    float b = textureLod(ripple_map, p.yx / 6.4 - scroll.yw, level).w;
    float line = 1.0 - abs(a + b - 1.0) * 2.4;
    // Averaged over, the net is even light.
    return mix(max(line, 0.0) * max(line, 0.0) * 0.9 + 0.72, 1.0, smoothstep(2.0, 4.0, level));
}

/// Radiance of the bed, and of the water before it, along the refracted ray from a point of the surface at a height above still
/// water; `depth` right below.
vec3 through_water(vec2 rest, float height, float depth, vec3 view, vec3 normal, vec3 deep, float distance) {
    // Past that nothing of the bed comes through.
    if (depth > 34.0) return deep;
    vec3 ray = refract(-view, normal, 1.0 / 1.34);
    float fall = max(-ray.y, 0.25);
    float way = max(depth, 0.0) / fall;
    vec2 seen = rest;
    for (int i = 0; i < 3; ++i) {
        seen = rest + ray.xz * way;
        // Half a step at a time: on slopes the whole one may swing.
        way = mix(way, max(height - bed_at(seen).x, 0.0) / fall, i == 0 ? 1.0 : 0.6);
    }
    float below = max(way * fall, 0.0);
    // Meadows of weed, their tile hidden by a larger one at another angle; from the air the mean of it all.
    float level = log2(distance * picture.x);
    vec2 turned = vec2(dot(seen, vec2(0.8, 0.6)), dot(seen, vec2(-0.6, 0.8)));
    vec4 marks = textureLod(foam_detail, turned / (1024.0 / 5.0), max(level + 0.3, 1.0));
    float wide = textureLod(foam_detail, seen / 1024.0, max(level - 2.0, 0.0)).x;
    float weed = smoothstep(0.56, 0.74, 0.5 * (marks.x + wide)) * smoothstep(1.0, 3.0, below);
    vec3 bed = mix(sand_below * (0.82 + 0.36 * marks.y), weed_below, weed);
    float sharp = (1.0 - smoothstep(25.0, 120.0, distance)) * smoothstep(0.05, 1.0, below) * (1.0 - smoothstep(3.0, 9.0, below));
    float focus = sharp > 0.0 ? mix(1.0, caustics(seen, below, level), sharp) : 1.0;
    // Sunlight comes down steeper than it fell in.
    float down = sqrt(1.0 - 0.556 * (1.0 - sun.y * sun.y));
    vec3 sunlit = sun_light.rgb * (0.30 * max(sun.y, 0.0) * focus) * exp(-extinction * (below / down));
    vec3 skylit = sky_ambient.rgb * 0.85 * exp(-extinction * (1.25 * below));
    vec3 through = exp(-extinction * way) * (1.0 - smoothstep(16.0, 34.0, depth));
    // Light that the water itself scatters grows with the way, up to the deep sea's.
    return bed * (sunlit + skylit) * through + deep * (1.0 - exp(-0.5 * (extinction.g + extinction.b) * 2.4 * (way + below)));
}
