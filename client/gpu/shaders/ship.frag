#include "frame.glsl"
#include "sky.glsl"
#include "noise.glsl"
in ShipVertex {
    vec3 position;
    vec3 normal;
    vec3 hull;
    vec4 paint;
} vertex;
uniform vec3 ship_size;  // length, beam, height of the waterline above still water, m
uniform float ship_wash;  // how high the bow throws the water up, m
out vec4 colour;

/// Share of white water on the plating, 0 to 1: the bow wave, falling off abaft, and a collar along the waterline.
float washed(vec3 hull) {
    float abaft = max(0.45 * ship_size.x - hull.x, 0.0);
    float thrown = ship_wash * exp(-abaft / (2.0 + 4.0 * ship_wash));
    float run = picture.z * 3.0;
    vec2 p = vec2(hull.x * 0.9 + run, hull.y * 2.1);
    float lumps = 0.6 * value_noise(p) + 0.4 * value_noise(p * 2.7 + 9.0);
    float edge = (thrown + 0.10 + 0.22 * ship_wash) * (0.25 + 1.5 * lumps);
    return smoothstep(0.0, 0.25 + 0.2 * thrown, edge - hull.y) * (0.55 + 0.45 * smoothstep(0.3, 0.7, lumps));
}

/// Salt, rust and the dark of what is often wet: streaks that run down the plating.
vec3 weathered(vec3 albedo, vec3 hull, float steepness) {
    float streaks = value_noise(vec2(hull.x * 1.7, hull.y * 0.25) + 40.0);
    float blotches = value_noise(hull.xz * 0.35 + hull.y * 0.21);
    vec3 worn = albedo * (0.86 + 0.28 * blotches);
    worn = mix(worn, vec3(0.16, 0.085, 0.05), 0.22 * steepness * smoothstep(0.62, 0.95, streaks));
    return worn * mix(0.6, 1.0, smoothstep(0.0, 0.9, hull.y));
}

void main() {
    vec3 view = -normalize(vertex.position);
    vec3 normal = normalize(vertex.normal);
    // The bulwark's inside shows the plating's back.
    vec3 facet = cross(dFdx(vertex.position), dFdy(vertex.position));
    if (dot(facet, normal) * dot(facet, view) < 0.0) normal = -normal;
    float white = washed(vertex.hull);
    float light = max(dot(normal, sun.xyz), 0.0);
    vec3 albedo = weathered(vertex.paint.rgb, vertex.hull, 1.0 - abs(normal.y));
    albedo = mix(albedo, vec3(0.80, 0.82, 0.84), white);
    // From below shines the sea.
    vec3 ambient = mix(vec3(0.25, 0.33, 0.36), vec3(1.0), 0.5 + 0.5 * normal.y) * sky_ambient.rgb;
    vec3 lit = albedo * (ambient + sun_light.rgb * (0.318 * light));
    float grazing = 1.0 - max(dot(normal, view), 0.0);
    float g2 = grazing * grazing;
    float mirror = vertex.paint.a * (0.04 + 0.96 * g2 * g2 * grazing);
    vec3 r = reflect(-view, normal);
    vec3 reflected = r.y > 0.0 ? reflected_sky(r, mix(6.0, 2.0, vertex.paint.a)) : 0.3 * sky_ambient.rgb;
    lit = mix(lit, reflected, min(mirror, 0.6) * (1.0 - white));
    colour = vec4(displayed(hazed(lit, vertex.position)), 1.0);
}
