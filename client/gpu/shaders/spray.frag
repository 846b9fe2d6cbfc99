#include "frame.glsl"
#include "sky.glsl"
#include "noise.glsl"
in vec4 puff;
in vec3 from_eye;
out vec4 colour;

void main() {
    vec2 p = gl_PointCoord * 2.0 - 1.0;
    float r2 = dot(p, p);
    if (r2 > 1.0) discard;
    // Torn rather than round.
    float torn = value_noise(p * 2.6 + puff.y * 61.0) * 0.6 + value_noise(p * 6.1 + puff.y * 17.0) * 0.4;
    float soft = (1.0 - r2) * (1.0 - r2) * smoothstep(0.25, 0.75, torn + 0.25 * (1.0 - r2));
    float towards = max(dot(normalize(from_eye), sun.xyz), 0.0);
    vec3 light = sky_ambient.rgb + sun_light.rgb * (0.22 + 0.25 * towards * towards * towards);
    colour = vec4(displayed(hazed(light, from_eye)), clamp(puff.x * soft * 1.6, 0.0, 1.0));
}
