// Waves too short for the mesh: layers of a scrolling normal map, and roughness where they are too small for the picture.
uniform sampler2D ripple_map;  // slopes, their squares' sum, height (ripple_map.hpp)

// Sides of the tiles of three layers, m. Axes come from 3-4-5 triangles and a fifth of 1024 m holds whole tiles, so the layers
// go on unbroken where the anchor moves.
const float fine_tile = 1024.0 / 300.0;
const float middle_tile = 1024.0 / 55.0;
const float coarse_tile = 1024.0 / 15.0;

struct Ripples {
    vec2 slope;      // along x and z
    float variance;  // of the slope, that the texture's averaging has taken away
    float height;    // 0 to 1
    float patches;   // the same at a coarse scale
};

/// One layer: slopes of variance `power` on a tile that travels along an axis. Where a tile has few pixels it would show as a
/// pattern: there it turns into roughness, and costs no texture look-up. `pixel` is log2 of the metres a pixel covers.
vec4 ripple_layer(vec2 rest, vec2 axis, float tile, vec2 travelled, float power, float footprint, float pixel) {
    float clear = min(tile / (footprint * 75.0) - 0.3, 1.0);
    if (clear <= 0.0 || power <= 0.0) return vec4(0.0, 0.0, power, 0.5);
    vec2 uv = vec2(dot(rest, axis), dot(rest, vec2(-axis.y, axis.x))) / tile - travelled;
    vec4 texel = textureLod(ripple_map, uv, pixel - log2(tile / 256.0));
    vec2 slope = texel.xy * clear;
    // The mean of the squares is 1 by construction.
    float lost = max(mix(1.0, texel.z, clear) - dot(slope, slope), 0.0) * power;
    slope *= sqrt(power);
    return vec4(axis * slope.x + vec2(-axis.y, axis.x) * slope.y, lost, texel.w);
}

/// log2 of the metres a pixel covers, between its long and its short side; at most two levels finer than the long one.
float log2_pixel(vec2 rest) {
    vec2 across = dFdx(rest);
    vec2 down = dFdy(rest);
    float a = 0.5 * log2(dot(across, across) + 1e-12);
    float b = 0.5 * log2(dot(down, down) + 1e-12);
    return max(0.6 * max(a, b) + 0.4 * min(a, b), max(a, b) - 2.0) - 0.25;
}

/// Short waves that the mesh cannot carry, of variance `power`, and in the coarse layer those that it no longer carries at this
/// distance.
Ripples ripples_at(vec2 rest, float power, float faded, float footprint, float pixel) {
    vec4 a = ripple_layer(rest, ripple_axes.xy, fine_tile, scroll.xw, 0.55 * power, footprint, pixel);
    vec4 b = ripple_layer(rest, ripple_axes.zw, middle_tile, scroll.yw, 0.45 * power, footprint, pixel);
    vec4 c = ripple_layer(rest, ripple_axes.xy, coarse_tile, scroll.zw, faded, footprint, pixel);
    return Ripples(a.xy + b.xy + c.xy, a.z + b.z + c.z, 0.5 * (a.w + b.w), c.w);
}
