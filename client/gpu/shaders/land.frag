#include "frame.glsl"
#include "sky.glsl"
#include "noise.glsl"
in LandVertex {
    vec3 position;
    vec3 normal;
    vec3 place;
} vertex;
out vec4 colour;

/// Noise of several scales, the finer ones only where they can be seen; about 0 to 1.
vec3 land_noise(vec2 p, float distance) {
    float coarse = value_noise(p * 0.011);
    float middle = value_noise(p * 0.053 + 31.0);
    float fine = distance < 3000.0 ? value_noise(p * 0.33) : 0.5;
    float grain = distance < 400.0 ? 0.5 * (value_noise(p * 1.9) + value_noise(p * 7.3)) : 0.5;
    return vec3(coarse, middle, 0.6 * fine + 0.4 * grain);
}

vec3 albedo(float height, float steepness, vec3 noise) {
    const vec3 wet_sand = vec3(0.235, 0.195, 0.140);
    const vec3 dry_sand = vec3(0.56, 0.49, 0.36);
    const vec3 grass = vec3(0.130, 0.165, 0.062);
    const vec3 heath = vec3(0.150, 0.128, 0.072);
    const vec3 rock = vec3(0.250, 0.235, 0.215);
    float h = height + (noise.y - 0.5) * 1.6 + (noise.z - 0.5) * 1.5;
    vec3 colour = mix(wet_sand, dry_sand, smoothstep(0.3, 1.3, h));
    vec3 green = mix(grass, heath, smoothstep(0.35, 0.75, noise.x * 0.6 + noise.y * 0.4));
    green *= 0.75 + 0.5 * noise.z;
    colour = mix(colour, green, smoothstep(2.5, 3.7, h + 1.5 * (noise.x - 0.5)));
    float stony = smoothstep(0.10, 0.26, steepness + 0.10 * (noise.y - 0.5) + 0.08 * (noise.z - 0.5));
    return mix(colour, rock * (0.65 + 0.7 * noise.z), stony);
}

void main() {
    float distance = length(vertex.position);
    vec3 noise = land_noise(vertex.place.xz, distance);
    vec3 normal = normalize(normalize(vertex.normal) + vec3(noise.y - 0.5, 0.0, noise.z - 0.5) * 0.45);
    float steepness = 1.0 - normalize(vertex.normal).y;
    vec3 base = albedo(vertex.place.y, steepness, noise);
    float light = max(dot(normal, sun.xyz), 0.0);
    vec3 lit = base * (sky_ambient.rgb * (0.55 + 0.45 * normal.y) + sun_light.rgb * (0.318 * light));
    // Under water the bed is only seen through it; the sea's own colour covers what is deeper.
    lit *= mix(0.45, 1.0, smoothstep(-0.8, 0.1, vertex.place.y));
    // Sand that the last wave has left is a mirror of the sky, the better the lower one looks.
    float wet = 1.0 - smoothstep(0.2, 0.75, vertex.place.y + 0.5 * (noise.y - 0.5) + 0.15 * (noise.z - 0.5));
    if (wet > 0.0 && steepness < 0.2) {
        vec3 view = -vertex.position / distance;
        vec3 film = normalize(vec3(normal.x * 0.25, 1.0, normal.z * 0.25));
        float grazing = 1.0 - max(dot(film, view), 0.0);
        float g2 = grazing * grazing;
        lit = mix(lit, reflected_sky(reflect(-view, film), 2.0), wet * (0.02 + 0.6 * g2 * g2));
    }
    colour = vec4(displayed(hazed(lit, vertex.position)), 1.0);
}
