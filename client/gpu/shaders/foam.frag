// One step of the foam map. A texel is a place at rest: r foam, g seconds since a crest broke there, b height of that crest, m,
// a a chance of its own.
#include "frame.glsl"
#include "spacing.glsl"
#include "displacement.glsl"
#include "patch_directory.glsl"
uniform sampler2D foam_map;     // before
uniform sampler2D foam_detail;
uniform ivec4 window;           // middle relative to the anchor (xy), log2 of a texel (lattice units), texels a side
uniform ivec4 window_before;    // middle then (xy), 1 = there is a history
uniform vec4 passing;           // seconds; what breaks, as a quantile of the Jacobian's distribution; drift, m/s; wind, m/s
out vec4 map;

const float spray_life = 2.4;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    int side = window.w;
    ivec2 first = (window.xy >> window.z) - side / 2;
    ivec2 index = first + ((texel - first) & (side - 1));
    ivec2 place = (index << window.z) + (1 << (window.z - 1));
    float texel_m = float(1 << window.z) * lattice_unit;
    displace(list_at(place), place, texel_m);
    vec3 normal = sea_normal();
    float exposed = clamp(total_variance / max(sea_state.x, 1e-5), 0.0, 1.0);
    vec2 at = vec2(place) * lattice_unit;
    vec2 p = vec2(dot(at, ripple_axes.xy), dot(at, vec2(-ripple_axes.y, ripple_axes.x)));
    // No crest breaks all along.
    float torn = textureLod(foam_detail, p / 102.4, 0.0).x - 0.5;
    float score = (1.0 - normal.y) / sea_state.w + 6.0 * torn;
    float breaking = smoothstep(1.25 * passing.y - 0.10, 1.25 * passing.y + 0.55, score) * smoothstep(0.2, 0.8, exposed);

    // Streaks down wind, where the water draws together: foam lives longer there.
    float streak = textureLod(foam_detail, p / 204.8, 1.0).z;
    ivec2 off = abs(index - (window_before.xy >> window.z));
    bool known = window_before.z != 0 && max(off.x, off.y) < side / 2 - 1;
    vec4 before = vec4(0.0, 60.0, 0.0, 0.0);
    if (known) {
        before = texelFetch(foam_map, texel, 0);
        vec2 uv = (vec2(texel) + 0.5 - wind.xy * (passing.z * passing.x / texel_m)) / float(side);
        before.x = textureLod(foam_map, uv, 0.0).x;
    }
    float windy = smoothstep(9.0, 22.0, passing.w);
    float life = mix(2.8, 5.0, windy) * mix(0.35, 1.8, streak * streak);
    float kept = before.x * exp(-passing.x / life);
    map.r = min(max(kept, breaking), 1.0);
    map.gba = vec3(min(before.y + passing.x, 60.0), before.zw);
    if (breaking > 0.30 && map.g > spray_life) {
        // The crest broke some time during the step.
        map.gba = vec3(0.0, sum_a.y, fract(score * 57.31 + p.x * 0.137));
    }
}
