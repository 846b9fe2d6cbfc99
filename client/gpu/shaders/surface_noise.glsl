// Gradient noise on the water: twin of surface_noise.cpp. Needs wide.glsl and sea_records.

uint noise_mix(uint v) {
    v ^= v >> 16;
    v *= 0x7feb352du;
    v ^= v >> 15;
    v *= 0x846ca68bu;
    return v ^ (v >> 16);
}

/// Value and derivatives per cell along x and z of one corner: (value, dx, dz).
vec3 noise_corner(uint hash, float fx, float fz, float ft) {
    uint top = hash >> 28;
    float first = (top & 1u) != 0u ? -1.0 : 1.0;
    float second = (top & 2u) != 0u ? -1.0 : 1.0;
    uint pair = top >> 2;
    float dx = pair == 2u ? 0.0 : first;
    float dz = pair == 1u ? 0.0 : (pair == 2u ? first : second);
    float dt = pair == 1u || pair == 2u ? second : 0.0;
    precise float value = (dx * fx + dz * fz) + dt * ft;
    return vec3(value, dx, dz);
}

vec3 noise_blend(vec3 a, vec3 b, float w) {
    precise vec3 blended = a + w * (b - a);
    return blended;
}

float noise_fade(float f) {
    precise float faded = ((f * f) * f) * (f * (f * 6.0 - 15.0) + 10.0);
    return faded;
}
float noise_fade_slope(float f) {
    precise float slope = (30.0 * (f * f)) * ((f - 1.0) * (f - 1.0));
    return slope;
}

/// One octave at a place (low 32 bits of the position): height before the amplitude, derivatives per cell. `layers`: hashes of the
/// time layers before and after, log2 of the lattice step, position between the layers (float bits); `layer_fade`: its fade.
vec3 noise_jet(ivec4 layers, float layer_fade, uvec2 place) {
    int step_log2 = layers.z;
    uvec2 cell = place >> step_log2;
    uvec2 next = (cell + 1u) & (0xffffffffu >> step_log2);
    uvec2 column = uvec2(cell.x, next.x) * 0x8da6b343u;
    uvec2 line = uvec2(cell.y, next.y) * 0xd8163841u;
    float per_unit = power_of_two(-step_log2);
    precise vec2 f = vec2(ivec2(place & ((1u << step_log2) - 1u))) * per_unit;
    precise float since = intBitsToFloat(layers.w);
    precise vec2 w = vec2(noise_fade(f.x), noise_fade(f.y));
    precise vec2 s = vec2(noise_fade_slope(f.x), noise_fade_slope(f.y));
    vec3 at_time[2];
    for (int t = 0; t < 2; ++t) {
        uint layer = uint(t == 0 ? layers.x : layers.y);
        precise float ft = t == 0 ? since : since - 1.0;
        precise float fx1 = f.x - 1.0;
        precise float fz1 = f.y - 1.0;
        vec3 nw = noise_corner(noise_mix(layer + line.x + column.x), f.x, f.y, ft);
        vec3 ne = noise_corner(noise_mix(layer + line.x + column.y), fx1, f.y, ft);
        vec3 sw = noise_corner(noise_mix(layer + line.y + column.x), f.x, fz1, ft);
        vec3 se = noise_corner(noise_mix(layer + line.y + column.y), fx1, fz1, ft);
        vec3 north = noise_blend(nw, ne, w.x);
        vec3 south = noise_blend(sw, se, w.x);
        precise float north_dx = north.y + s.x * (ne.x - nw.x);
        precise float south_dx = south.y + s.x * (se.x - sw.x);
        north.y = north_dx;
        south.y = south_dx;
        vec3 both = noise_blend(north, south, w.y);
        precise float dz = both.z + s.y * (south.x - north.x);
        both.z = dz;
        at_time[t] = both;
    }
    return noise_blend(at_time[0], at_time[1], layer_fade);
}

/// The same by its row in the records.
vec3 noise_octave(int row, uvec2 place) {
    return noise_jet(texelFetch(sea_records, row), intBitsToFloat(texelFetch(sea_records, row + 1).x), place);
}
