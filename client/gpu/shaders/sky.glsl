// Light of the sky and the sun; purely visual. Radiances are relative, exposure and tone curve bring them to the screen.
uniform samplerCube sky_cube;   // the sky with clouds, for reflections; its levels are ever rougher
uniform samplerCube clear_sky;  // the sky without them

/// Sky towards a unit vector without clouds and the sun's disc; below the horizon as at it.
vec3 sky_without_clouds(vec3 d) {
    vec3 clear = textureLod(clear_sky, vec3(d.x, max(d.y, 0.0), d.z), 0.0).rgb;
    // An overcast sky is brightest overhead, but less so above the sea's spray.
    return mix(clear, overcast.rgb * (0.72 + 0.28 * max(d.y, 0.0)), overcast.w);
}

/// What a surface of some roughness reflects from a direction: `level` of the map, 0 = mirror.
vec3 reflected_sky(vec3 d, float level) { return textureLod(sky_cube, vec3(d.x, max(d.y, 0.004), d.z), level).rgb; }

/// What the air between adds.
vec3 hazed(vec3 colour, vec3 position) {
    float distance = length(position);
    float thick = distance * picture.y;
    // Less than a step of the screen's 8 bits.
    if (thick < 0.004) return colour;
    // Less and less is added: the line of the horizon stays even from on high.
    float through = exp(-thick / (1.0 + 0.3 * thick));
    vec3 d = position / max(distance, 1e-3);
    return mix(sky_without_clouds(normalize(vec3(d.x, 0.004, d.z))), colour, through);
}

/// Filmic curve (Narkowicz 2015) and the screen's gamma, with half a step of noise against banding. Moonlight has little colour.
vec3 displayed(vec3 colour) {
    colour *= sun_light.w;
    float grey = dot(colour, vec3(0.2126, 0.7152, 0.0722));
    colour = mix(colour, grey * vec3(0.72, 0.92, 1.25), 0.75 * sky_ambient.w);
    vec3 c = clamp(colour * (2.51 * colour + 0.03) / (colour * (2.43 * colour + 0.59) + 0.14), 0.0, 1.0);
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    return pow(c, vec3(1.0 / 2.2)) + (noise - 0.5) / 255.0;
}
