// Colour of the water's surface, for the near mesh and the far disc alike; purely visual.
uniform sampler2D ripple_map;  // slopes, their squares' sum, height (ripple_map.hpp)
uniform sampler2D bed_map;     // height of the bed, m

const vec3 deep_water = vec3(0.006, 0.038, 0.060);
const vec3 sand_below = vec3(0.42, 0.38, 0.28);
const vec3 extinction = vec3(0.42, 0.085, 0.065);  // 1/m, clear coastal water
const vec3 foam_colour = vec3(0.80, 0.83, 0.85);

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
    float clear = min(tile / (footprint * 150.0) - 0.3, 1.0);
    if (clear <= 0.0) return vec4(0.0, 0.0, power, 0.5);
    vec2 uv = vec2(dot(rest, axis), dot(rest, vec2(-axis.y, axis.x))) / tile - travelled;
    vec4 texel = textureLod(ripple_map, uv, pixel - log2(tile / 256.0));
    vec2 slope = texel.xy * clear;
    // The mean of the squares is 1 by construction.
    float lost = max(mix(1.0, texel.z, clear) - dot(slope, slope), 0.0) * power;
    slope *= sqrt(power);
    return vec4(axis * slope.x + vec2(-axis.y, axis.x) * slope.y, lost, texel.w);
}

/// Short waves that the mesh cannot carry, and in the coarse layer those that it no longer carries at this distance.
Ripples ripples_at(vec2 rest, float power, float faded, float distance) {
    vec2 across = dFdx(rest);
    vec2 down = dFdy(rest);
    float pixel = 0.5 * log2(max(dot(across, across), dot(down, down)) + 1e-12) + -0.5;
    float footprint = distance * picture.x;
    vec4 a = ripple_layer(rest, ripple_axes.xy, fine_tile, scroll.xw, 1.4 * power, footprint, pixel);
    vec4 b = ripple_layer(rest, ripple_axes.zw, middle_tile, scroll.yw, power, footprint, pixel);
    vec4 c = ripple_layer(rest, ripple_axes.xy, coarse_tile, scroll.zw, faded, footprint, pixel);
    return Ripples(a.xy + b.xy + c.xy, a.z + b.z + c.z, 0.5 * (a.w + b.w), c.w);
}

/// Mean Fresnel reflectance of a rough sea (Bruneton et al. 2010, eq. 16), n = 1.34.
float fresnel(float cosine, float sigma2) {
    float sigma = sqrt(sigma2);
    return 0.0211 + 0.9789 * pow(1.0 - cosine, 5.0 * exp(-2.69 * sigma)) / (1.0 + 22.7 * sigma * sqrt(sigma));
}

/// Sun's light off facets whose slopes are spread by sigma2 (per axis) about `slope`.
float glitter(vec3 view, vec2 slope, float sigma2) {
    vec3 h = normalize(view + sun.xyz);
    vec2 wanted = -h.xz / h.y - slope;
    float p = exp(-0.5 * dot(wanted, wanted) / sigma2) / (6.2831853 * sigma2);
    float grazing = 1.0 - max(dot(h, view), 0.0);
    float g2 = grazing * grazing;
    float f = 0.0211 + 0.9789 * g2 * g2 * grazing;
    float h2 = h.y * h.y;
    return min(f * p / (4.0 * h2 * h2 * max(view.y, 0.08)), 9.0);
}

/// Light from below the surface: deep water, or the bed through shallow water.
vec3 body(float depth, vec3 view, vec3 normal, float crest) {
    vec3 down_light = sky_ambient * 0.75 + sun_light * (0.25 * sun.y);
    float sunwards = max(dot(-view.xz, sun.xz), 0.0);
    vec3 deep = deep_water * down_light * (0.85 + 0.3 * normal.y);
    deep += vec3(0.008, 0.060, 0.055) * (crest * (0.35 + 1.6 * sunwards * sunwards));
    vec3 seen = exp(-extinction * (2.2 * max(depth, 0.0)));
    return mix(deep, sand_below * down_light, seen);
}

/// Share of the surface that is foam: where crests fold, and where waves break on the shore.
float foam_share(float jacobian, float depth, float waves, Ripples ripples) {
    float folding = 1.0 - smoothstep(foam.x - 0.35, foam.x, jacobian);
    // Runs of white that come and go with the depth under them, broken up by the ripples.
    float surf_depth = foam.y + 1.2 * waves;
    float near_shore = 1.0 - smoothstep(0.15, surf_depth, depth);
    float runs = 0.5 + 0.5 * sin(depth * 5.0 + picture.z * 1.1 + 3.0 * ripples.height);
    float surf = near_shore * smoothstep(0.35, 0.8, runs * (0.55 + 0.9 * ripples.patches)) * step(-1.5, depth);
    float lace = smoothstep(0.32, 0.62, ripples.height);
    return clamp(folding * (0.25 + 0.75 * lace) + surf * (0.35 + 0.65 * lace), 0.0, 1.0);
}

/// Height of the bed, m, and how far outside the terrain's raster the place lies, m: there the bed falls from the raster's
/// edge to the open sea's (height_at, terrain.cpp).
vec2 bed_at(vec2 rest) {
    vec2 at = rest * bed_transform.xy + bed_transform.zw;
    vec2 half_texel = 0.5 / vec2(textureSize(bed_map, 0));
    vec2 beyond = abs(at - clamp(at, half_texel, 1.0 - half_texel)) / bed_transform.xy;
    float outside = max(beyond.x, beyond.y);
    return vec2(mix(texture(bed_map, at).x, foam.z, min(outside / foam.w, 1.0)), outside);
}

vec4 water_colour(vec3 position, vec3 mesh_normal, vec2 rest, vec3 interpolated) {
    // Interpolation may leave a variance of 0 a little below it.
    vec3 waves = vec3(interpolated.x, max(interpolated.yz, 0.0));
    float distance = length(position);
    vec3 view = -position / distance;
    float power = min(0.0035 + 0.20 * waves.z, 0.014);
    float coarse = min(0.8 * waves.y + 0.1 * waves.z, 0.018);
    Ripples ripples = ripples_at(rest, power, coarse, distance);
    vec2 slope = -mesh_normal.xz / max(mesh_normal.y, 0.15) + ripples.slope;
    vec3 normal = normalize(vec3(-slope.x, 1.0, -slope.y));
    float sigma2 = 0.5 * (ripples.variance + max(waves.y - coarse, 0.0)) + 0.0008;

    vec2 bed = bed_at(rest);
    float depth = waves.x - bed.x;

    // Facets that face away are not seen: what is seen leans towards the viewer.
    float facing = dot(normal, view);
    float cosine = max(facing, 0.0) + 0.25 * sqrt(sigma2) * (1.0 - max(facing, 0.0));
    float reflectance = fresnel(min(cosine, 1.0), sigma2);
    vec3 r = reflect(-view, normal);
    r.y = sqrt(r.y * r.y + 0.35 * sigma2);
    vec3 reflected = sky_radiance(normalize(r));
    float crest = clamp(waves.x * 0.45 + 0.15, 0.0, 1.0) * clamp(1.0 - facing, 0.0, 1.0);
    vec3 colour = mix(body(depth, view, normal, crest), reflected, reflectance);
    colour += sun_light * (0.5 * glitter(view, slope, sigma2));
    float white = foam_share(mesh_normal.y, depth, sqrt(waves.z), ripples);
    vec3 foam_light = foam_colour * (sky_ambient + sun_light * (0.32 * max(dot(normal, sun.xyz), 0.0)));
    colour = mix(colour, foam_light, white * 0.9);
    // No land is drawn beyond the raster, so nothing but water may show there.
    float cover = bed.y > 0.5 ? 1.0 : clamp(depth * 3.0, 0.0, 1.0);
    return vec4(displayed(hazed(colour, position)), max(cover, 0.0));
}
