#include "frame.glsl"
#include "sky.glsl"
#include "noise.glsl"
in vec3 direction;
out vec4 colour;

/// Thin fair-weather clouds on a plane, 0 to 1.
float clouds(vec3 d) {
    vec2 p = d.xz * (2.2 / (d.y + 0.06)) + vec2(picture.w, 0.35 * picture.w);
    p += 0.6 * vec2(value_noise(p * 0.7), value_noise(p * 0.7 + 19.0));
    float sum = 0.0;
    float amplitude = 0.5;
    for (int i = 0; i < 5; ++i) {
        sum += amplitude * value_noise(p);
        p = mat2(1.6, 1.2, -1.2, 1.6) * p + 7.3;
        amplitude *= 0.5;
    }
    return smoothstep(0.50, 0.86, sum) * smoothstep(0.0, 0.22, d.y);
}

void main() {
    vec3 d = normalize(direction);
    vec3 sky = sky_radiance(d);
    float towards = max(dot(d, sun.xyz), 0.0);
    if (d.y > 0.0) {
        float cover = clouds(d);
        float lit = 0.72 + 0.5 * towards * towards * towards * towards;
        sky = mix(sky, vec3(0.95, 0.94, 0.93) * lit, 0.75 * cover);
        // 0.6 degrees across would be true; a little larger reads as the sun through thin haze.
        float disc = smoothstep(0.99988, 0.99996, towards);
        sky += vec3(18.0, 15.5, 11.5) * disc * (1.0 - 0.6 * cover);
    }
    colour = vec4(displayed(sky), 1.0);
}
