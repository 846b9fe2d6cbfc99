// Seas for comparison with the sum of trains: gradient noise (paper D, section 4.1) and a tile made by Fourier transform. They leave
// the same sums as sea.glsl. Filled by client/gpu/other_seas.cpp; needs surface_noise.glsl and spacing.glsl.
uniform sampler2D fft_displacement;  // aX, height, aZ, daX/dz
uniform sampler2D fft_slope;         // dh/dx, dh/dz, daX/dx, daZ/dz
layout(std140) uniform OtherSeas {
    ivec4 noise_layers[8];  // as noise_jet takes them
    vec4 noise_scale[8];    // fade between the layers; height, m; height over cell; wavelength, m
    ivec4 other_counts;     // octaves; log2 of the tile's side, lattice units; log2 of its samples a side; 0
    vec4 fft_variance[3];   // slope variance that is left at each mip level
};

void sum_noise(ivec2 place, float spacing) {
    uvec2 low = uvec2(camera_cell.zw + place);
    for (int i = 0; i < other_counts.x; ++i) {
        vec4 scale = noise_scale[i];
        float weight = displayed_weight(scale.w, spacing);
        float variance = OCTAVE_MEAN_SQUARE * scale.z * scale.z;
        total_variance += variance;
        faded_variance += variance * (1.0 - weight * weight);
        if (weight <= 0.0) continue;
        vec3 jet = noise_jet(noise_layers[i], scale.x, low);
        sum_a.y += weight * scale.y * jet.x;
        sum_b -= weight * scale.z * jet.yz;
    }
}

float fft_variance_at(float level) {
    int below = clamp(int(level), 0, 10);
    float first = fft_variance[below >> 2][below & 3];
    float second = fft_variance[(below + 1) >> 2][(below + 1) & 3];
    return mix(first, second, clamp(level - float(below), 0.0, 1.0));
}

void sum_fft(ivec2 place, float spacing) {
    uvec2 low = uvec2(camera_cell.zw + place) & ((1u << other_counts.y) - 1u);
    // Samples lie at texels' centres.
    float samples = float(1 << other_counts.z);
    vec2 uv = vec2(low) * exp2(-float(other_counts.y)) + 0.5 / samples;
    float sample_m = exp2(float(other_counts.y - other_counts.z)) * lattice_unit;
    float level = max(log2(2.0 * spacing / sample_m), 0.0);
    vec4 d = textureLod(fft_displacement, uv, level);
    vec4 s = textureLod(fft_slope, uv, level);
    sum_a = d.xyz;
    sum_b = -s.xy;
    sum_m = vec4(s.z, d.w, d.w, s.w);
    total_variance = fft_variance[0].x;
    faded_variance = max(total_variance - fft_variance_at(level), 0.0);
}
