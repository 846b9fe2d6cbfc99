// Where the surface is white. Needs ripples.glsl.
uniform sampler2D foam_map;     // r: foam that crests have left behind (foam.frag)
uniform sampler2D foam_detail;  // whitecap noise, lace, streaks, whitecap noise (foam_detail.hpp)

const float cap_tile = 1024.0 / 10.0;       // m
const float wide_tile = 1024.0 / 3.0;        // m
const float lace_tile = 1024.0 / 205.0;     // m
const float tangle_tile = 1024.0 / 45.0;    // m

/// Coordinates along and across the wind, m.
vec2 along_wind(vec2 rest) {
    return vec2(dot(rest, ripple_axes.xy), dot(rest, vec2(-ripple_axes.y, ripple_axes.x)));
}

/// Share that whitecaps cover (x) and thin streaks that a storm draws down wind (y). The Jacobian is known but for
/// `unknown` of its variance: noise stands in for the rest, so that everywhere, near or far, the mean over the sea is the wind's.
vec2 whitecaps(float jacobian, float unknown, vec2 p, float pixel) {
    if (sea_state.z > 3.9) return vec2(0.0);
    float known = (1.0 - jacobian) / sea_state.w;
    float by_noise = unknown + 0.30;
    // The quantile moves with the spread that noise adds to the distribution.
    float limit = sea_state.z * sqrt(1.0 + 0.30 + 0.05);
    float storm = smoothstep(13.0, 26.0, wind.z);
    if (storm <= 0.0 && known + 3.0 * sqrt(by_noise) < limit) return vec2(0.0);
    float level = max(pixel - log2(cap_tile / 256.0), 0.0);
    // Two patterns that travel with the waves and take turns: caps come and go.
    float blend = 0.5 - 0.5 * cos(0.7853982 * picture.z);
    vec4 texel = textureLod(foam_detail, (p - vec2(0.22 * wind.z * picture.z, 0.0)) / cap_tile, level);
    float noise = (texel.x - 0.5) * 8.0 * sqrt(1.0 - blend) + (texel.w - 0.5) * 8.0 * sqrt(blend);
    // From the air many tiles are seen at once: a second, larger one at another angle takes the repetition away.
    float high = 0.75 * smoothstep(-3.0, -0.5, pixel);
    if (high > 0.0) {
        vec2 q = vec2(dot(p, vec2(0.8, 0.6)), dot(p, vec2(-0.6, 0.8))) / wide_tile;
        vec2 other = textureLod(foam_detail, q, max(pixel - log2(wide_tile / 256.0), 0.0)).xz;
        noise = noise * sqrt(1.0 - high * high) + (other.x - 0.5) * 8.0 * high;
        storm *= mix(1.0, 2.0 * other.y, high);
    }
    // Where the caps are smaller than a few pixels, the share that they cover on average.
    float small = smoothstep(1.5, 4.5, level);
    float score = known + sqrt(by_noise) * noise * (1.0 - small);
    float spread = sqrt(0.05 + small * by_noise);
    float streaks = storm * mix(0.55 * smoothstep(0.66, 0.98, texel.z), 0.10, small);
    return vec2(1.0 / (1.0 + exp(clamp(-1.7 * (score - limit) / spread, -30.0, 30.0))), streaks);
}

/// Foam of some density becomes a net with holes, then threads, before it is gone.
float laced(float density, vec2 p, float pixel) {
    if (density <= 0.004) return 0.0;
    float level = pixel - log2(lace_tile / 256.0);
    float near = 1.0 - smoothstep(1.5, 4.5, level);
    float fine = near > 0.0 ? textureLod(foam_detail, p / lace_tile, max(level, 0.0)).y : 0.5;
    float middle = pixel - log2(tangle_tile / 256.0);
    vec4 tangle = textureLod(foam_detail, p / tangle_tile, max(middle, 0.0));
    // A net up close, tufts and threads farther off.
    float lace = 0.42 * tangle.y + 0.25 * tangle.z + mix(0.165, 0.33 * fine, near);
    float solid = smoothstep(0.0, 0.42, 1.3 * density - 0.84 + lace) * min(1.0, 0.2 + 0.9 * density + 0.35 * lace * density);
    return mix(solid, density, smoothstep(2.5, 5.5, middle));
}

/// Breaking on the shore: white runs that come in with the depth under them, torn by noise.
float surf(float depth, float waves, vec2 p, Ripples ripples, float pixel) {
    float surf_depth = foam.y + 1.2 * waves;
    if (depth > surf_depth || depth < -1.5) return 0.0;
    float near_shore = 1.0 - smoothstep(0.1, surf_depth, depth);
    float level = max(pixel - log2(61.0 / 256.0), 0.0);
    float torn = textureLod(foam_detail, p / 61.0 + vec2(0.011 * picture.z, 0.0), level).y;
    float phase = depth * 3.3 / (0.35 + 0.5 * waves) + picture.z * 0.9 + 5.0 * torn + 2.0 * ripples.patches;
    float saw = fract(phase / 6.2831853);
    // A bore: steep white front, thinning behind.
    float run = smoothstep(0.0, 0.08, saw) * exp(-2.6 * saw);
    float wash = 0.55 * (1.0 - smoothstep(0.0, 0.55, abs(depth)));
    return clamp(near_shore * (1.25 * run * (0.35 + 0.65 * torn) + wash), 0.0, 1.0);
}

/// Density of foam that the map remembers, and how much the map counts here (it ends softly).
vec2 remembered_foam(vec2 rest) {
    if (foam_map_place.z <= 0.0) return vec2(0.0);
    vec2 off = abs(rest - foam_map_place.xy) / foam_map_place.z;
    float counts = 1.0 - smoothstep(0.36, 0.47, max(off.x, off.y));
    if (counts <= 0.0) return vec2(0.0);
    return vec2(textureLod(foam_map, rest / foam_map_place.z, 0.0).x * counts, counts);
}
