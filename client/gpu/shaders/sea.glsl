// The sea at a lattice place: twin of SeaInstant::evaluate (protocol/model/sea.cpp), the same operations in the same order on
// the same integers and float32, so the bits agree. Everything that enters a result is `precise`: no contraction.
// Tables and their layout: client/scene/sea_table.cpp and land_table.cpp. TRAIN_ROW and OCTAVE_ROW are texels a row.

uniform isamplerBuffer sea_records;  // RGBA32I: rows of boxes, trains, land fields
uniform isamplerBuffer sea_lists;    // RG32I: number of entries, then (row of a box, trains)
uniform isamplerBuffer land_slots;   // R32I: first node of a block, -1 = none
uniform isamplerBuffer land_nodes;   // RG32I: shift (2^-16 turn), gain (Q1.15) and orbit (Q2.14) in two halves

const int block_cells = 16;
const int block_nodes = 17;
const uint full_gain = 0x1000000u;

#include "wide.glsl"
#include "wake.glsl"
#include "surface_noise.glsl"

// Layers that the shader leaves out itself: Layer of sea.hpp.
const int layer_trains = 1;
const int layer_shelter = 2;
const int layer_refraction = 4;
const int layer_orbits = 32;
bool has_layer(int layer) { return (mesh_cell.z & layer) != 0; }

// ---- envelope of a box: wave_train_box.cpp ----

struct Envelope {
    uint gain;   // Q0.24
    vec2 slope;  // per metre along x and z
    ivec2 at;    // u and v, of a box limited there
};

uint ramp_gain(int distance, int length, int reciprocal) {
    if (distance <= 0) return 0u;
    if (distance >= length) return full_gain;
    return product_shifted(uint(distance), uint(reciprocal), 16);
}
float ramp_slope(int distance, int length, float slope) { return distance > 0 && distance < length ? slope : 0.0; }

Envelope envelope_at(int row, ivec2 r) {
    Envelope e = Envelope(0u, vec2(0.0), ivec2(0));
    ivec4 axes = texelFetch(sea_records, row + 1);
    uint time_gain = uint(axes.w);
    if (time_gain == 0u) return e;
    if (axes.z == 0) {
        e.gain = time_gain;
        return e;
    }
    ivec4 reach = texelFetch(sea_records, row + 2);
    if (r.x < reach.x || r.y < reach.y || r.x > reach.z || r.y > reach.w) return e;
    ivec4 base = texelFetch(sea_records, row);
    ivec4 ramps = texelFetch(sea_records, row + 3);
    ivec4 reciprocals = texelFetch(sea_records, row + 4);
    vec3 slopes = intBitsToFloat(texelFetch(sea_records, row + 5).xyz);
    uint rear = full_gain, front = full_gain, left = full_gain, right = full_gain;
    float rear_slope = 0.0, front_slope = 0.0, left_slope = 0.0, right_slope = 0.0;
    if ((axes.z & 1) != 0) {
        int u = along_axis(base.xy, r, axes.xy);
        e.at.x = u;
        rear = ramp_gain(u, ramps.x, reciprocals.x);
        front = ramp_gain(ramps.w - u, ramps.y, reciprocals.y);
        rear_slope = ramp_slope(u, ramps.x, slopes.x);
        front_slope = -ramp_slope(ramps.w - u, ramps.y, slopes.y);
    }
    if ((axes.z & 2) != 0) {
        int v = along_axis(base.zw, r, ivec2(-axes.y, axes.x));
        e.at.y = v;
        left = ramp_gain(v, ramps.z, reciprocals.z);
        right = ramp_gain(reciprocals.w - v, ramps.z, reciprocals.z);
        left_slope = ramp_slope(v, ramps.z, slopes.z);
        right_slope = -ramp_slope(reciprocals.w - v, ramps.z, slopes.z);
    }
    uint along = times(rear, front);
    uint across = times(left, right);
    e.gain = times(times(along, across), time_gain);
    if (e.gain == 0u) return e;
    precise float in_u = (rear_slope * unit(front) + unit(rear) * front_slope) * unit(across) * unit(time_gain);
    precise float in_v = (left_slope * unit(right) + unit(left) * right_slope) * unit(along) * unit(time_gain);
    vec2 u_axis = intBitsToFloat(texelFetch(sea_records, row + 6).xy);
    precise float in_x = in_u * u_axis.x - in_v * u_axis.y;
    precise float in_z = in_u * u_axis.y + in_v * u_axis.x;
    e.slope = vec2(in_x, in_z);
    return e;
}

// ---- land field: land_field.cpp ----

struct Land {
    uint shift;        // turns, Q0.32
    uint gain;         // Q1.24
    vec2 shift_slope;  // rad/m
    vec2 gain_slope;   // 1/m
    float orbit;       // factor on the horizontal orbit
    vec2 orbit_slope;  // 1/m
};
const Land open_water = Land(0u, full_gain, vec2(0.0), vec2(0.0), 1.0, vec2(0.0));

/// Bilinear between four values of 16 bits at a place in the cell, Q0.16: value, east - west, south - north, 8 bits finer.
ivec3 between_nodes(uvec4 n, uvec2 g) {
    uvec2 h = uvec2(65536u) - g;
    int west = int((n.x * h.y + n.z * g.y) >> 8);
    int east = int((n.y * h.y + n.w * g.y) >> 8);
    int north = int((n.x * h.x + n.y * g.x) >> 8);
    int south = int((n.z * h.x + n.w * g.x) >> 8);
    return ivec3(west + signed_product_shifted(east - west, int(g.x), 16), east - west, south - north);
}

Land land_at(int row, ivec2 r) {
    Land land = open_water;
    ivec4 place = texelFetch(sea_records, row);
    ivec4 window = texelFetch(sea_records, row + 1);
    int step_log2 = place.z;
    ivec2 node = place.xy + (r >> step_log2);
    ivec2 block = node >> 4;
    if (block.x < 0 || block.y < 0 || block.x >= window.x || block.y >= window.y) return land;
    int first = texelFetch(land_slots, place.w + block.y * window.x + block.x).x;
    if (first < 0) return land;
    // Position in the cell, Q0.16: (r mod step) * 2^16 / step, which only ever needs 32 bits.
    ivec2 rest = r & ((1 << step_log2) - 1);
    ivec2 f = step_log2 > 16 ? rest >> (step_log2 - 16) : rest << (16 - step_log2);
    int n00 = first + (node.y & 15) * block_nodes + (node.x & 15);
    ivec2 v00 = texelFetch(land_nodes, n00).xy;
    ivec2 v10 = texelFetch(land_nodes, n00 + 1).xy;
    ivec2 v01 = texelFetch(land_nodes, n00 + block_nodes).xy;
    ivec2 v11 = texelFetch(land_nodes, n00 + block_nodes + 1).xy;

    vec2 per_step = intBitsToFloat(window.zw);
    if (has_layer(layer_refraction)) {
        int cross_slope = (v11.x - v01.x) - (v10.x - v00.x);
        int slope_x = (v10.x - v00.x) + signed_product_shifted(cross_slope, f.y, 16);
        int slope_z = (v01.x - v00.x) + signed_product_shifted(cross_slope, f.x, 16);
        land.shift = uint(v00.x) * 65536u + uint(v01.x - v00.x) * uint(f.y) + uint(slope_x) * uint(f.x);
        precise vec2 shift_slope = vec2(float(slope_x), float(slope_z)) * per_step.x;
        land.shift_slope = shift_slope;
    }
    uvec4 halves = uvec4(v00.y, v10.y, v01.y, v11.y);
    if (has_layer(layer_shelter)) {
        ivec3 gain = between_nodes(halves & 0xffffu, uvec2(f));
        land.gain = uint(gain.x) << 1;
        precise vec2 gain_slope = vec2(gain.yz) * per_step.y;
        land.gain_slope = gain_slope;
    }
    if (has_layer(layer_orbits)) {
        ivec3 orbit = between_nodes(halves >> 16, uvec2(f));
        land.orbit = float(orbit.x) * uintBitsToFloat(0x34800000u);
        precise vec2 orbit_slope = vec2(orbit.yz) * (2.0 * per_step.y);
        land.orbit_slope = orbit_slope;
    }
    return land;
}

// ---- irregular heights: irregular_height.cpp ----

struct Modulation {
    float factor;
    vec2 slope;  // 1/m
};

Modulation modulation_at(int row, uvec2 place) {
    ivec4 first = texelFetch(sea_records, row);
    ivec4 second = texelFetch(sea_records, row + 1);
    vec4 k = intBitsToFloat(texelFetch(sea_records, row + 2));
    float share = intBitsToFloat(first.w);
    float sin_u, cos_u, sin_v, cos_v;
    sincos_turns(uint(first.x) * place.x + uint(first.y) * place.y + uint(first.z), sin_u, cos_u);
    sincos_turns(uint(second.x) * place.x + uint(second.y) * place.y + uint(second.z), sin_v, cos_v);
    precise float along = cos_u * sin_v;
    precise float across = sin_u * cos_v;
    precise float factor = 1.0 - share * (sin_u * sin_v);
    precise vec2 slope = -(share * (along * k.xy + across * k.zw));
    return Modulation(factor, slope);
}

// ---- round waves: round_wave.cpp ----

/// Where a place lies across its box.
struct RoundPlace {
    uint a;     // lattice units off the middle
    uint f;     // of the width, Q0.30
    bool left;  // of the course
};

RoundPlace round_place(int row, int width, int v) {
    int off = clamp(v, 0, width) - width / 2;
    uint a = uint(abs(off));
    uint reciprocal = uint(texelFetch(sea_records, row).x);
    return RoundPlace(a, min(product_shifted(a, reciprocal, 9), 0x40000000u), off < 0);
}

/// n: (wave number * roundness) >> 15. Shift in turns, Q0.32, slope in rad/m across the box.
uint round_shift(RoundPlace at, uint n, out float slope) {
    uint high, low;
    umulExtended(at.f, n, high, low);
    uint whole = (high << 1) | (low >> 31);
    precise float steepness = (float(int(whole)) * uintBitsToFloat(0x35000000u)) * uintBitsToFloat(0x40c90fdbu);
    slope = at.left ? -steepness : steepness;
    return at.a * whole + product_shifted(at.a, low & 0x7fffffffu, 31);
}

// ---- the sum: sea.cpp ----

struct Local {
    uint shift;
    float g;        // gain of the vertical orbit
    vec2 slope;     // its gradient, 1/m
    float gh;       // gain of the horizontal orbit
    vec2 slope_h;   // its gradient, 1/m
    vec2 turn;      // gradient of the shift, rad/m
};

Local combine(Envelope e, Land land, Modulation m) {
    precise float gain = gain_to_float(product_shifted(e.gain, land.gain, 24));
    precise float box_gain = gain_to_float(e.gain);
    precise float land_gain = gain_to_float(land.gain);
    precise vec2 gain_slope = e.slope * land_gain + box_gain * land.gain_slope;
    precise float g = gain * m.factor;
    precise vec2 slope = gain_slope * m.factor + gain * m.slope;
    precise float gh = g * land.orbit;
    precise vec2 slope_h = slope * land.orbit + g * land.orbit_slope;
    return Local(land.shift, g, slope, gh, slope_h, land.shift_slope);
}

// Accumulators; acc = (coefficient * value) + acc, each rounded on its own.
precise vec3 sum_a;     // (aX, aY, aZ), m
precise vec2 sum_b;
precise vec4 sum_m;     // mxx, mxz, mzx, mzz
float faded_variance;   // slope variance of what is not displayed
float total_variance;   // of the whole sea
#ifdef TROCHOID_PROBE
uint phase_digest;      // of all phases in the order of the sum
uvec2 trains_counted;   // looked at, and evaluated
#endif

/// A plane wave as add_train of sea.cpp takes it.
struct Wave {
    vec2 k;  // rad/m
    float a;
    vec2 h;  // chi A d, m
};

void add_wave(Wave t, Local l, uint phase, float weight) {
    float wave_sin, wave_cos;
    sincos_turns(phase, wave_sin, wave_cos);
    precise float g = l.g * weight;
    precise float gh = l.gh * weight;
    precise float s = g * wave_sin;
    precise float c = g * wave_cos;
    precise float sh = gh * wave_sin;
    precise float ch = gh * wave_cos;
    precise float kx = t.k.x + l.turn.x;
    precise float kz = t.k.y + l.turn.y;
    sum_a = vec3(t.h.x, t.a, t.h.y) * vec3(sh, c, sh) + sum_a;
    sum_b = vec2(t.a * kx, t.a * kz) * s + sum_b;
    sum_m = vec4(t.h.x * kx, t.h.x * kz, t.h.y * kx, t.h.y * kz) * ch + sum_m;
    if (l.slope.x != 0.0 || l.slope.y != 0.0 || l.slope_h.x != 0.0 || l.slope_h.y != 0.0) {
        precise vec2 d = l.slope * weight;
        precise vec2 dh = l.slope_h * weight;
        sum_b = (t.a * -d) * wave_cos + sum_b;
        sum_m = vec4(t.h.x * dh.x, t.h.x * dh.y, t.h.y * dh.x, t.h.y * dh.y) * wave_sin + sum_m;
    }
}

#ifdef TROCHOID_PROBE
#define NOTE_PHASE(phase) phase_digest = (phase_digest ^ (phase)) * 16777619u
#define NOTE_TRAIN(weight) trains_counted += uvec2(1u, (weight) > 0.0 ? 1u : 0u)
#else
#define NOTE_PHASE(phase)
#define NOTE_TRAIN(weight)
#endif

/// Trains of a box; `features` is its last texel.
void add_trains(int row, int count, ivec4 features, Envelope e, ivec2 r, uvec2 place, float spacing) {
    int trains = texelFetch(sea_records, row + 5).w;
    int first = texelFetch(sea_records, row + 6).z;
    if (trains == 0) return;
    Modulation m = Modulation(1.0, vec2(0.0));
    if (features.x >= 0) m = modulation_at(features.x, place);
    Local local = combine(e, open_water, m);
    int field = -1;
    vec2 across = vec2(0.0);
    RoundPlace bend = RoundPlace(0u, 0u, false);
    if (features.z >= 0) {
        vec2 u_axis = intBitsToFloat(texelFetch(sea_records, row + 6).xy);
        across = vec2(-u_axis.y, u_axis.x);
        bend = round_place(features.z, texelFetch(sea_records, row + 4).w, e.at.y);
    }
    total_variance += local.g * local.g * intBitsToFloat(texelFetch(sea_records, first + 2).w);
    vec2 limits = spacing_limits(spacing);
    int shown = 0;
    for (; shown < count; ++shown) {
        int train = first + shown * TRAIN_ROW;
        ivec4 wave = texelFetch(sea_records, train);
        if (wave.w != field) {
            field = wave.w;
            Land land = open_water;
            if (field >= 0) land = land_at(field, r);
            local = combine(e, land, m);
        }
        uint phase = uint(wave.x) * place.x + uint(wave.y) * place.y + uint(wave.z) + local.shift;
        Local bent = local;
        if (features.z >= 0) {
            ivec4 four = texelFetch(sea_records, features.z + 1 + (shown >> 2));
            float bent_slope;
            phase += round_shift(bend, uint(four[shown & 3]), bent_slope);
            precise vec2 turn = bent_slope * across + local.turn;
            bent.turn = turn;
        }
        vec4 c0 = intBitsToFloat(texelFetch(sea_records, train + 1));  // kx, kz, a, hx
        vec4 c1 = intBitsToFloat(texelFetch(sea_records, train + 2));  // hz, wavelength, slope variance, that from here on
        float weight = 1.0;
        if (mesh_filter.z == 0.0 && c1.y < 4.0 * limits.y) {
            weight = displayed_weight(c1.y, wave_spacing(c0.xy + bent.turn, vec2(0.0), c1.y, spacing));
            faded_variance += local.g * local.g * c1.z * (1.0 - weight * weight);
        }
        NOTE_PHASE(phase);
        NOTE_TRAIN(weight);
        if (weight > 0.0)
            add_wave(Wave(c0.xy, c0.z, vec2(c0.w, c1.x)), bent, phase, weight);
        else if (!shorter_may_show(c1.y, limits.x))
            break;  // trains come by falling wavelength: all others fade too
    }
    // The one that ended the loop has counted itself already; those behind it, and what the server left out, follow.
    int rest = shown < count ? shown + 1 : shown;
    if (rest < trains) faded_variance += local.g * local.g * intBitsToFloat(texelFetch(sea_records, first + rest * TRAIN_ROW + 2).w);
}

void add_wake_wave(WakeWave w, float amplitude, float choppy, float longest, Envelope e, vec2 u_axis, float spacing) {
    if (amplitude == 0.0 || w.gain == 0u) return;
    precise vec2 d = vec2(w.d.x * u_axis.x - w.d.y * u_axis.y, w.d.x * u_axis.y + w.d.y * u_axis.x);
    precise vec2 k = vec2(w.k.x * u_axis.x - w.k.y * u_axis.y, w.k.x * u_axis.y + w.k.y * u_axis.x);
    precise vec2 h = choppy * d;
    precise vec2 slope = vec2(w.gain_slope.x * u_axis.x - w.gain_slope.y * u_axis.y,
                              w.gain_slope.x * u_axis.y + w.gain_slope.y * u_axis.x);
    Land as_land = open_water;
    as_land.gain = w.gain;
    as_land.gain_slope = slope;
    Local local = combine(e, as_land, Modulation(1.0, vec2(0.0)));
    float weight = 1.0;
    if (mesh_filter.z == 0.0) {
        // What the server leaves out is weightless here: no wave of the pattern counts as longer than lambda0. Where the
        // amplitude falls within less than a wave (the wedge's edge) that counts like a shorter wave.
        vec2 fall = local.slope / max(local.g, 1e-6);
        float wavelength = min(6.2831853 * inversesqrt(dot(k, k) + dot(fall, fall)), longest);
        weight = displayed_weight(wavelength, wave_spacing(k, fall, wavelength, spacing));
        float steep = amplitude * local.g;
        float variance = 0.5 * steep * steep * dot(k, k);
        faded_variance += variance * (1.0 - weight * weight);
        total_variance += variance;
    }
    NOTE_PHASE(w.phase);
    if (weight > 0.0) add_wave(Wave(k, amplitude, h), local, w.phase, weight);
}

void add_wake(int row, int wake, Envelope e, float spacing) {
    vec4 chop = intBitsToFloat(texelFetch(sea_records, wake + 2));
    if (mesh_filter.z == 0.0 && displayed_weight(chop.w, spacing_limits(spacing).x) <= 0.0) return;
    WakePlace at = wake_place(wake, e.at.x, e.at.y);
    if (at.tau == 0xffffffffu) return;
    vec2 amplitudes = intBitsToFloat(texelFetch(sea_records, wake + 1).yz);
    vec2 u_axis = intBitsToFloat(texelFetch(sea_records, row + 6).xy);
    add_wake_wave(wake_wave(0, at, 0xe0000000u), amplitudes.x, chop.x, chop.w, e, u_axis, spacing);
    add_wake_wave(wake_wave(wake_nodes_each, at, 0x20000000u), amplitudes.y, chop.y, chop.w, e, u_axis, spacing);
}

void add_noise(int first, int octaves, Envelope e, uvec2 place, float spacing) {
    precise float g = gain_to_float(e.gain);
    precise float height = 0.0;
    precise vec2 slope = vec2(0.0);
    total_variance += g * g * intBitsToFloat(texelFetch(sea_records, first + 2).z);
    for (int i = 0; i < octaves; ++i) {
        int row = first + i * OCTAVE_ROW;
        vec3 shown = intBitsToFloat(texelFetch(sea_records, row + 2).xyz);
        float weight = mesh_filter.z == 0.0 ? displayed_weight(shown.x, spacing) : 1.0;
        if (weight <= 0.0) {
            faded_variance += g * g * shown.z;
            break;  // octaves come by falling length
        }
        faded_variance += g * g * shown.y * (1.0 - weight * weight);
        vec2 scale = intBitsToFloat(texelFetch(sea_records, row + 1).zw);
        vec3 jet = noise_octave(row, place);
        precise float octave_height = scale.x * weight;
        precise float octave_slope = scale.y * weight;
        height = octave_height * jet.x + height;
        slope = octave_slope * jet.yz + slope;
    }
    sum_a.y = g * height + sum_a.y;
    sum_b = -g * slope + sum_b;
    sum_b = -e.slope * height + sum_b;
}

void add_box(ivec2 entry, ivec2 r, uvec2 place, float spacing) {
    int row = entry.x;
    Envelope e = envelope_at(row, r);
    if (e.gain == 0u) return;
    ivec4 features = texelFetch(sea_records, row + 7);
    if (has_layer(layer_trains)) add_trains(row, entry.y, features, e, r, place, spacing);
    if (features.y >= 0) add_wake(row, features.y, e, spacing);
    if (features.w >= 0) add_noise(features.w, texelFetch(sea_records, row + 6).w, e, place, spacing);
}

void clear_sums() {
    sum_a = vec3(0.0);
    sum_b = vec2(0.0);
    sum_m = vec4(0.0);
    faded_variance = 0.0;
    total_variance = 0.0;
#ifdef TROCHOID_PROBE
    phase_digest = 2166136261u;
    trains_counted = uvec2(0u);
#endif
}

/// Sums the boxes of a list at a place relative to the anchor; the sums above hold the result.
void sum_sea(int list, ivec2 r, float spacing) {
    clear_sums();
    uvec2 place = uvec2(camera_cell.zw + r);
    int entries = texelFetch(sea_lists, list).x;
    for (int i = 1; i <= entries; ++i) add_box(texelFetch(sea_lists, list + i).xy, r, place, spacing);
}

/// Still water of so much roughness.
void still_sea(float variance) {
    sum_a = vec3(0.0);
    sum_b = vec2(0.0);
    sum_m = vec4(0.0);
    faded_variance = variance;
    total_variance = variance;
}

/// Unnormalised normal of the sums; its y is the Jacobian determinant.
vec3 sea_normal() {
    precise float pxx = 1.0 - sum_m.x;
    precise float pxz = -sum_m.y;
    precise float pzx = -sum_m.z;
    precise float pzz = 1.0 - sum_m.w;
    precise float yx = -sum_b.x;
    precise float yz = -sum_b.y;
    precise vec3 n = vec3(yz * pzx - pzz * yx, pzz * pxx - pxz * pzx, pxz * yx - yz * pxx);
    return n;
}
