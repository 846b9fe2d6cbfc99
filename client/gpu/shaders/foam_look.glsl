// Where the surface is white. Needs ripples.glsl.
uniform sampler2D foam_map;     // r: foam that crests have left behind (foam.frag)
uniform sampler2D foam_detail;  // whitecap noise, lace, streaks, whitecap noise (foam_detail.hpp)

const float cap_tile = 1024.0 / 10.0;       // m
const float wide_tile = 1024.0 / 5.0;       // m
const float surf_tile = 1024.0 / 17.0;      // m
const float lace_tile = 1024.0 / 205.0;     // m
const vec2 tangle_tile = vec2(1024.0 / 25.0, 1024.0 / 45.0);  // m; the wind draws it out

/// Coordinates along and across the wind, m.
vec2 along_wind(vec2 rest) {
    return vec2(dot(rest, ripple_axes.xy), dot(rest, vec2(-ripple_axes.y, ripple_axes.x)));
}

/// Share of the whitecap noise's variance that a level of its texture still has.
float noise_left(float level) { return exp(-exp2(2.0 * level - 6.3)); }

/// Share of a normal distribution below x (Page 1977), good in the tails too: rare caps are where they matter.
float normal_share(float x) { return 1.0 / (1.0 + exp(clamp(-1.5976 * x - 0.070565 * x * x * x, -30.0, 30.0))); }

/// Share that whitecaps cover (x) and thin streaks that a storm draws down wind (y). The Jacobian is known but for
/// `unknown` of its variance: noise stands in for the rest, so that everywhere, near or far, the mean over the sea is the wind's.
vec2 whitecaps(float jacobian, float unknown, vec2 p, float pixel) {
    if (sea_state.z > 3.9) return vec2(0.0);
    float known = (1.0 - jacobian) / sea_state.w;
    float by_noise = unknown + 0.30;
    // The quantile moves with the spread that noise adds to the distribution.
    float limit = sea_state.z * sqrt(1.0 + 0.30 + 0.05);
    float storm = smoothstep(13.0, 26.0, wind.z);
    if (storm <= 0.0 && known + 3.7 * sqrt(by_noise) < limit) return vec2(0.0);
    float level = max(pixel - log2(cap_tile / 256.0), 0.0);
    // Two patterns that travel with the waves and take turns: caps come and go.
    float blend = clamp(0.5 - 0.5 * cos(0.7853982 * picture.z), 0.0, 1.0);
    vec4 texel = textureLod(foam_detail, (p - vec2(0.22 * wind.z * picture.z, 0.0)) / cap_tile, level);
    float noise = (texel.x - 0.5) * 8.0 * sqrt(1.0 - blend) + (texel.w - 0.5) * 8.0 * sqrt(blend);
    float left = noise_left(level);
    // From the air many tiles are seen at once: a second, larger one at another angle takes the repetition away.
    float high = 0.6 * smoothstep(-3.0, -0.5, pixel);
    if (high > 0.0) {
        // Turned so that 1024 m, by which the anchor moves, are whole tiles whatever ripple_axes.
        float turn = ripple_axes.x * ripple_axes.y * (abs(ripple_axes.x) - abs(ripple_axes.y)) > 0.0 ? -0.6 : 0.6;
        vec2 q = vec2(dot(p, vec2(0.8, turn)), dot(p, vec2(-turn, 0.8))) / wide_tile;
        float wide = max(pixel - log2(wide_tile / 256.0), 0.0);
        vec2 other = textureLod(foam_detail, q, wide).xz;
        noise = noise * sqrt(1.0 - high * high) + (other.x - 0.5) * 8.0 * high;
        left = mix(left, noise_left(wide), high * high);
        // What is coarse in the noise is no cap: and from higher still its tiles would show.
        float fine = 1.0 - smoothstep(1.5, 3.3, pixel);
        noise *= fine;
        left *= fine * fine;
        storm *= mix(1.0, 2.0 * other.y, high);
    }
    // Where the caps are smaller than a few pixels, the share that they cover on average.
    float score = known + sqrt(by_noise) * noise;
    float spread = sqrt(0.05 + by_noise * (1.0 - left));
    float streaks = storm * mix(0.55 * smoothstep(0.66, 0.98, texel.z), 0.10, smoothstep(1.5, 4.5, level));
    return vec2(normal_share((score - limit) / spread), streaks);
}

/// What there is of foam at a place.
struct Foam {
    float cover;   // share of the surface, 0 to 1
    float body;    // from a film of bubbles, 0, to the thick white of a crest that breaks, 1
    float relief;  // its lumps and hollows, about -1 to 1
    float milk;    // bubbles under the surface, 0 to 1
};

/// Foam of some density becomes a net with holes, then threads, before it is gone; on average it covers just its density.
Foam laced(float density, vec2 p, float pixel) {
    // Less than a step of the screen's 8 bits.
    if (density <= 0.002) return Foam(0.0, 0.0, 0.0, 0.0);
    float level = pixel - log2(lace_tile / 256.0);
    float near = 1.0 - smoothstep(1.5, 4.5, level);
    float fine = near > 0.0 ? textureLod(foam_detail, p / lace_tile, max(level, 0.0)).y : 0.5;
    float middle = pixel - log2(tangle_tile.y / 256.0);
    vec4 tangle = textureLod(foam_detail, p / tangle_tile, max(middle, 0.0));
    // Evenly distributed each; together about normal.
    float net = (0.50 * tangle.y + 0.25 * tangle.z + 0.25 * mix(0.5, fine, near) - 0.5) * 5.6;
    float clear = 1.0 - smoothstep(1.5, 4.5, middle);
    // The net's level above which there is so much of it (logistic for normal), and how far above it this place lies.
    float held = min(density, 0.985);
    float above = 0.588 * log(held / (1.0 - held)) * 1.06 + net;
    float solid = 1.0 / (1.0 + exp(clamp(-4.9 * above, -30.0, 30.0)));
    float body = mix(0.55 + 0.4 * density, clamp(0.15 + 0.55 * density + 0.14 * above, 0.0, 1.0), clear);
    return Foam(mix(density, solid, clear), body, (0.45 * net + 0.9 * (fine - 0.5) * near) * clear, density);
}

/// Breaking on the shore: white runs that come in with the depth under them, torn by noise.
float surf(float depth, float waves, vec2 p, Ripples ripples, float pixel) {
    float surf_depth = foam.y + 1.2 * waves;
    if (depth > surf_depth || depth < -1.5) return 0.0;
    float near_shore = 1.0 - smoothstep(0.1, surf_depth, depth);
    float level = max(pixel - log2(surf_tile / 256.0), 0.0);
    float torn = textureLod(foam_detail, p / surf_tile + vec2(0.011 * picture.z, 0.0), level).y;
    float phase = depth * 3.3 / (0.35 + 0.5 * waves) + picture.z * 0.9 + 5.0 * torn + 2.0 * ripples.patches;
    float saw = fract(phase / 6.2831853);
    // A bore: steep white front, thinning behind.
    float run = smoothstep(0.0, 0.08, saw) * exp(-2.6 * saw);
    float wash = 0.55 * (1.0 - smoothstep(0.0, 0.55, abs(depth)));
    return clamp(near_shore * (1.25 * run * (0.35 + 0.65 * torn) + wash), 0.0, 1.0);
}

/// Density of foam that the map remembers, and how much the map counts here (it ends softly, also where its texels are smaller
/// than pixels: from the air they would flicker).
vec2 remembered_foam(vec2 rest, float pixel) {
    if (foam_map_place.z <= 0.0) return vec2(0.0);
    vec2 off = abs(rest - foam_map_place.xy) / foam_map_place.z;
    float counts = (1.0 - smoothstep(0.36, 0.47, max(off.x, off.y))) * (1.0 - smoothstep(0.2, 1.4, pixel));
    if (counts <= 0.0) return vec2(0.0);
    return vec2(textureLod(foam_map, rest / foam_map_place.z, 0.0).x * counts, counts);
}
