// How high the ground lies, under water and above it. Needs frame.glsl.
uniform sampler2D bed_map;  // height of the bed, m

/// Height of the bed, m, and how far outside the terrain's raster the place lies, m: there the bed falls from the raster's
/// edge to the open sea's (height_at, terrain.cpp).
vec2 bed_at(vec2 rest) {
    vec2 at = rest * bed_transform.xy + bed_transform.zw;
    vec2 half_texel = 0.5 / vec2(textureSize(bed_map, 0));
    vec2 beyond = abs(at - clamp(at, half_texel, 1.0 - half_texel)) / bed_transform.xy;
    float outside = max(beyond.x, beyond.y);
    return vec2(mix(textureLod(bed_map, at, 0.0).x, foam.z, min(outside / foam.w, 1.0)), outside);
}
