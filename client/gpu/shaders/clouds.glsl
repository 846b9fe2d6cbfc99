// Clouds on a plane: fair-weather ones, and the torn grey of storms. Needs frame.glsl, sky.glsl, noise.glsl.

/// Colour times cover, and the cover, in a direction above the horizon, from so many octaves of noise.
vec4 clouds(vec3 d, int octaves) {
    float rise = max(d.y, 0.0);
    if (rise < 0.004) return vec4(0.0);
    float storm = overcast.w;
    vec2 p = d.xz * (2.2 / (rise + 0.06)) + wind.xy * picture.w;
    p += 0.6 * vec2(value_noise(p * 0.7), value_noise(p * 0.7 + 19.0));
    float sum = 0.0;
    float amplitude = 0.5;
    for (int i = 0; i < octaves; ++i) {
        sum += amplitude * value_noise(p);
        p = mat2(1.6, 1.2, -1.2, 1.6) * p + 7.3;
        amplitude *= 0.5;
    }
    // What the octaves left out would have had on average.
    sum += amplitude * (1.0 - exp2(float(octaves) - 5.0));
    float open = mix(0.50, 0.40, storm);
    float fade = smoothstep(0.0, mix(0.22, 0.12, storm), rise);
    float thick = smoothstep(open, open + 0.36, sum);
    float towards = max(dot(d, sun.xyz), 0.0);
    float t4 = towards * towards * towards * towards;
    // Lit from above; the thick parts are darker below, the thin edges near the sun shine.
    vec3 white = sky_ambient.rgb * 1.05 + sun_light.rgb * (0.105 + 0.08 * t4) * (1.0 - 0.45 * thick);
    vec3 grey = overcast.rgb * (0.78 + 0.75 * (0.5 - sum));
    float cover = mix(0.78 * thick, 0.85, storm) * fade;
    return vec4(mix(white, grey, storm) * cover, cover);
}
