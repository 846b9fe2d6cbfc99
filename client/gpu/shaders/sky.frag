#include "frame.glsl"
#include "sky.glsl"
#include "noise.glsl"
#include "clouds.glsl"
in vec3 direction;
out vec4 colour;

/// A few stars, each about a pixel wide.
float stars(vec3 d) {
    vec3 p = d * 190.0;
    ivec3 cell = ivec3(floor(p));
    float chance = hash(cell.xy * 57 + cell.z * ivec2(131, 17));
    vec3 off = fract(p) - 0.5;
    return chance > 0.994 ? smoothstep(0.08, 0.0, dot(off, off)) * (chance - 0.994) * 160.0 : 0.0;
}

void main() {
    vec3 d = normalize(direction);
    vec3 sky = sky_without_clouds(d);
    if (d.y > -0.002) {
        vec4 cloud = clouds(d, 5);
        float towards = max(dot(d, sun.xyz), 0.0);
        // 0.6 degrees across would be true; a little larger reads as the disc through thin haze.
        float disc = smoothstep(0.99988, 0.99996, towards);
        float t8 = pow(towards, 900.0);
        sky += sun_light.rgb * (0.10 * t8 + 0.9 * pow(t8, 14.0)) * (1.0 - overcast.w) * (1.0 - cloud.a);
        sky += sun_light.rgb * disc * mix(4.0, 2.4, sky_ambient.w) * (1.0 - overcast.w);
        if (sky_ambient.w > 0.3) sky += vec3(0.0011) * stars(d) * (sky_ambient.w - 0.3) * max(d.y * 3.0, 0.0);
        sky = sky * (1.0 - cloud.a) + cloud.rgb;
    }
    colour = vec4(displayed(sky), 1.0);
}
