// Colour of the water's surface, for the near mesh and the far disc alike; purely visual.
#include "ripples.glsl"
#include "foam_look.glsl"
#include "bed.glsl"

const vec3 deep_water = vec3(0.006, 0.036, 0.058);
const vec3 thick_foam = vec3(0.83, 0.85, 0.86);
const vec3 thin_foam = vec3(0.38, 0.47, 0.50);
const vec3 milky_water = vec3(0.10, 0.22, 0.24);

const int far_combined = 0;
const int far_spectrum = 1;
const int far_texture = 2;

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
    return min(f * p / (4.0 * h2 * h2 * max(view.y, 0.06)), 14.0);
}

/// Light that comes up out of deep water; crests against the light let some through.
vec3 deep_light(vec3 view, vec3 normal, float crest) {
    vec3 down_light = sky_ambient.rgb * 0.8 + sun_light.rgb * (0.25 * max(sun.y, 0.0));
    float sunwards = max(dot(-view.xz, sun.xz), 0.0);
    vec3 deep = deep_water * down_light * (0.85 + 0.3 * normal.y);
    vec3 lit = 0.30 * sky_ambient.rgb + sun_light.rgb * (0.16 * sunwards * sunwards);
    return deep + vec3(0.010, 0.060, 0.050) * lit * crest;
}

struct Roughness {
    float ripples;  // slope variance of the normal map's fine layers
    float faded;    // of its coarse layer: waves that the mesh no longer carries
    float rest;     // of what is neither displaced nor mapped
};

/// Shares out the slope variance that the mesh leaves over (`waves`: height, not displayed, of the whole sea), so that with the
/// mesh's own it sums up to Cox and Munk's at every distance. In a lee, where there is less of the sea, there are fewer ripples.
Roughness roughness_of(vec3 waves) {
    float exposed = clamp(waves.z / max(sea_state.x, 1e-5), 0.12, 1.3);
    float added = sea_state.y * exposed;
    if (choice.y == far_spectrum) return Roughness(0.0, 0.0, added + waves.y);
    float mapped = min(0.72 * added, 0.048);
    float coarse = min(0.85 * waves.y, 0.022);
    return Roughness(mapped, coarse, added - mapped + waves.y - coarse);
}

/// Foam at a place.
Foam foam_at(float jacobian, float depth, vec3 waves, vec2 rest, Ripples ripples, float pixel) {
    vec2 p = along_wind(rest);
    vec2 history = remembered_foam(rest, pixel);
    float unknown = clamp(waves.y / max(waves.z, 1e-6), 0.0, 1.0);
    float exposed = clamp(waves.z / max(sea_state.x, 1e-5), 0.0, 1.0);
    vec2 caps = whitecaps(jacobian, unknown, p, pixel) * smoothstep(0.2, 0.8, exposed);
    // Where the map remembers, what breaks just now is the smaller part of the foam.
    float density = max(max(caps.x * (1.0 - 0.5 * history.y), history.x), caps.y);
    return laced(max(density, surf(depth, sqrt(max(waves.z, 0.0)) * 4.0, rest, ripples, pixel)), p, pixel);
}

/// Light off foam, a rough body of its own: it shades by the waves and by its lumps; a film is grey and blue with what is below.
vec3 foam_light(Foam white, vec2 slope) {
    vec3 lumps = normalize(vec3(-1.6 * slope.x, 1.0, -1.6 * slope.y));
    vec3 albedo = mix(thin_foam, thick_foam, white.body) * clamp(1.0 + 0.48 * white.relief, 0.5, 1.2);
    return albedo * (sky_ambient.rgb * (0.45 + 0.55 * lumps.y * lumps.y) + sun_light.rgb * (0.25 * max(dot(lumps, sun.xyz), 0.0)));
}

/// Dry ground as it looks from afar, so high above still water.
vec3 dry_ground(float height) {
    vec3 ground = mix(vec3(0.56, 0.49, 0.36), vec3(0.135, 0.155, 0.066), smoothstep(2.5, 3.7, height));
    return ground * (0.95 * sky_ambient.rgb + sun_light.rgb * (0.318 * max(sun.y, 0.0)));
}

vec4 water_colour(vec3 position, vec3 mesh_normal, vec2 rest, vec3 interpolated) {
    // Interpolation may leave a variance of 0 a little below it.
    vec3 waves = vec3(interpolated.x, max(interpolated.yz, 0.0));
    float distance = length(position);
    vec3 view = -position / distance;
    float pixel = log2_pixel(rest);
    Roughness rough = roughness_of(waves);
    Ripples ripples = ripples_at(rest, rough.ripples, rough.faded, distance * picture.x, pixel);
    vec2 slope = -mesh_normal.xz / max(mesh_normal.y, 0.15) + ripples.slope;
    vec3 normal = normalize(vec3(-slope.x, 1.0, -slope.y));
    float sigma2 = 0.5 * (ripples.variance + rough.rest) + 0.0007;

    vec2 bed = bed_at(rest);
    float depth = waves.x - bed.x;

    // Facets that face away are not seen: what is seen leans towards the viewer.
    float facing = dot(normal, view);
    float cosine = max(facing, 0.0) + 0.25 * sqrt(sigma2) * (1.0 - max(facing, 0.0));
    float reflectance = fresnel(min(cosine, 1.0), sigma2);
    vec3 r = reflect(-view, normal);
    r.y = sqrt(r.y * r.y + 0.7 * sigma2);
    vec3 reflected = reflected_sky(normalize(r), 0.5 * log2(sigma2) + 6.0);
    float crest = clamp(waves.x * 0.30 + 0.15, 0.0, 1.0) * clamp(1.0 - facing, 0.0, 1.0);
    vec3 below = through_water(rest, waves.x, depth, view, normal, deep_light(view, normal, crest), distance);
    // A crest seen edge on is thinner than a pixel: its white would break into dashes.
    float edge = smoothstep(-0.02, 0.07, dot(normalize(mesh_normal), view));
    Foam white = foam_at(mesh_normal.y, depth, waves, rest, ripples, pixel);
    float opaque = white.cover * edge * mix(0.62, 0.97, white.body);
    // The root, so that 8 bits hold small shares too.
    if (choice.w == 1) return vec4(vec3(sqrt(opaque)), 1.0);
    below += milky_water * (sky_ambient.rgb + sun_light.rgb * (0.3 * max(sun.y, 0.0))) * (0.8 * white.milk);
    vec3 colour = mix(below, reflected, reflectance);
    colour += sun_light.rgb * (0.5 * glitter(view, slope, sigma2));
    if (opaque > 0.0) colour = mix(colour, foam_light(white, slope), opaque);
    // No land is drawn beyond the raster, so nothing but water may show there.
    float cover = bed.y > 0.5 ? 1.0 : clamp(depth * 3.0, 0.0, 1.0);
    // Land that is drawn coarser than the bed's map, or not at all, leaves places with nothing behind: there the map's ground
    // shows. Up close only well above the water, for a beach is finer than the map.
    float far = smoothstep(1.0, 4.0, distance * picture.x);
    float dry = bed.y > 0.5 ? 0.0 : smoothstep(1.0 - far, 3.0 - 2.7 * far, -depth);
    colour = mix(colour, dry_ground(bed.x), dry);
    cover = max(max(cover, dry), far);
    return vec4(displayed(hazed(colour, position)), cover);
}
