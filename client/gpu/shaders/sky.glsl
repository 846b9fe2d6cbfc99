// Light of the sky and the sun; purely visual. Radiances are relative, the tone curve brings them to the screen.
const vec3 sun_light = vec3(5.6, 4.9, 3.9);       // irradiance of the sun across its rays
const vec3 sky_zenith = vec3(0.085, 0.215, 0.52);
const vec3 sky_middle = vec3(0.27, 0.47, 0.74);
const vec3 sky_horizon = vec3(0.70, 0.79, 0.86);
const vec3 sky_ambient = vec3(0.34, 0.46, 0.62);  // mean over the upper half, times pi over pi

/// Clear sky towards a unit vector, without the sun's disc; below the horizon as at it.
vec3 sky_radiance(vec3 d) {
    float up = max(d.y, 0.0);
    float down = 1.0 - up;
    float d2 = down * down;
    float d4 = d2 * d2;
    vec3 colour = mix(sky_zenith, sky_middle, d2 * down);
    colour = mix(colour, sky_horizon, d4 * d4 * d4);
    float towards = max(dot(d, sun.xyz), 0.0);
    float t2 = towards * towards;
    float t4 = t2 * t2;
    float t16 = t4 * t4 * t4 * t4;
    colour += vec3(1.0, 0.82, 0.58) * (0.10 * t4 + 0.22 * t16 + 0.5 * t16 * t16 * t16 * t16);
    return colour;
}

/// What the air between adds.
vec3 hazed(vec3 colour, vec3 position) {
    float distance = length(position);
    vec3 d = position / max(distance, 1e-3);
    vec3 air = sky_radiance(normalize(vec3(d.x, 0.015, d.z)));
    return mix(air, colour, exp(-distance * picture.y));
}

/// Filmic curve (Narkowicz 2015) and the screen's gamma, with half a step of noise against banding.
vec3 displayed(vec3 colour) {
    colour *= 0.82;
    vec3 c = clamp(colour * (2.51 * colour + 0.03) / (colour * (2.43 * colour + 0.59) + 0.14), 0.0, 1.0);
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    return pow(c, vec3(1.0 / 2.2)) + (noise - 0.5) / 255.0;
}
