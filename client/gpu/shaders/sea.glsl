// The sea at a lattice place: twin of SeaInstant::evaluate (protocol/model/sea.cpp), the same operations in the same order on
// the same integers and float32, so the bits agree. Everything that enters a result is `precise`: no contraction.
// Tables and their layout: client/scene/sea_table.cpp and land_table.cpp. BOX_ROW and TRAIN_ROW are their texels a row.

uniform isamplerBuffer sea_records;  // RGBA32I: rows of boxes, trains, land fields
uniform isamplerBuffer sea_lists;    // RG32I: number of entries, then (row of a box, trains)
uniform isamplerBuffer land_slots;   // R32I: first node of a block, -1 = none
uniform isamplerBuffer land_nodes;   // RG32I: shift (2^-16 turn), gain (Q1.15)

const int block_cells = 16;
const int block_nodes = 17;
const uint full_gain = 0x1000000u;

// ---- sine and cosine of a phase in turns, Q0.32: sincos.hpp, coefficients as bits ----

void sincos_turns(uint phase, out float sine_out, out float cosine_out) {
    precise float t = float(int(phase << 2) >> 8) * uintBitsToFloat(0x34000000u);
    precise float z = t * t;
    precise float sine = t * (uintBitsToFloat(0x3f490fdau) + z * (uintBitsToFloat(0xbda55dbeu) +
                         z * (uintBitsToFloat(0x3b232873u) + z * uintBitsToFloat(0xb815dfa5u))));
    precise float cosine = 1.0 + z * (uintBitsToFloat(0xbe9de9d1u) + z * (uintBitsToFloat(0x3c81d8c7u) +
                           z * uintBitsToFloat(0xb9a7588au)));
    uint q = phase + 0x20000000u;
    bool swapped = (q & 0x40000000u) != 0u;
    sine_out = uintBitsToFloat(floatBitsToUint(swapped ? cosine : sine) ^ (q & 0x80000000u));
    cosine_out = uintBitsToFloat(floatBitsToUint(swapped ? sine : cosine) ^ ((q + 0x40000000u) & 0x80000000u));
}

// ---- integers wider than 32 bits ----

/// (a * b) >> shift, shift 1 to 31, low 32 bits.
uint product_shifted(uint a, uint b, int shift) {
    uint high, low;
    umulExtended(a, b, high, low);
    return (high << (32 - shift)) | (low >> shift);
}
int signed_product_shifted(int a, int b, int shift) {
    int high, low;
    imulExtended(a, b, high, low);
    return (high << (32 - shift)) | int(uint(low) >> shift);
}

/// (base + r.x * axis.x + r.y * axis.y) >> 30 in 64 bits, held between -1 and 2^31 - 1 (beyond, every ramp is saturated).
int along_axis(ivec2 base, ivec2 r, ivec2 axis) {
    int high_x, low_x, high_z, low_z;
    imulExtended(r.x, axis.x, high_x, low_x);
    imulExtended(r.y, axis.y, high_z, low_z);
    uint carry_x, carry_z;
    uint low = uaddCarry(uint(base.x), uint(low_x), carry_x);
    low = uaddCarry(low, uint(low_z), carry_z);
    int high = base.y + high_x + high_z + int(carry_x + carry_z);
    if (high < 0) return -1;
    if (high >= 0x20000000) return 0x7fffffff;
    return int((uint(high) << 2) | (low >> 30));
}

// ---- envelope of a box: wave_train_box.cpp ----

struct Envelope {
    uint gain;   // Q0.24
    vec2 slope;  // per metre along x and z
};

float unit(uint gain) { return float(gain) * uintBitsToFloat(0x33800000u); }
uint times(uint a, uint b) { return product_shifted(a, b, 24); }

uint ramp_gain(int distance, int length, int reciprocal) {
    if (distance <= 0) return 0u;
    if (distance >= length) return full_gain;
    return product_shifted(uint(distance), uint(reciprocal), 16);
}
float ramp_slope(int distance, int length, float slope) { return distance > 0 && distance < length ? slope : 0.0; }

Envelope envelope_at(int row, ivec2 r) {
    Envelope e = Envelope(0u, vec2(0.0));
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
        rear = ramp_gain(u, ramps.x, reciprocals.x);
        front = ramp_gain(ramps.w - u, ramps.y, reciprocals.y);
        rear_slope = ramp_slope(u, ramps.x, slopes.x);
        front_slope = -ramp_slope(ramps.w - u, ramps.y, slopes.y);
    }
    if ((axes.z & 2) != 0) {
        int v = along_axis(base.zw, r, ivec2(-axes.y, axes.x));
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
};

Land land_at(int row, ivec2 r) {
    Land land = Land(0u, full_gain, vec2(0.0), vec2(0.0));
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

    int cross_slope = (v11.x - v01.x) - (v10.x - v00.x);
    int slope_x = (v10.x - v00.x) + signed_product_shifted(cross_slope, f.y, 16);
    int slope_z = (v01.x - v00.x) + signed_product_shifted(cross_slope, f.x, 16);
    land.shift = uint(v00.x) * 65536u + uint(v01.x - v00.x) * uint(f.y) + uint(slope_x) * uint(f.x);
    vec2 per_step = intBitsToFloat(window.zw);
    precise vec2 shift_slope = vec2(float(slope_x), float(slope_z)) * per_step.x;
    land.shift_slope = shift_slope;

    uvec2 g = uvec2(f);
    uvec2 h = uvec2(65536u) - g;
    int west = int((uint(v00.y) * h.y + uint(v01.y) * g.y) >> 8);
    int east = int((uint(v10.y) * h.y + uint(v11.y) * g.y) >> 8);
    int north = int((uint(v00.y) * h.x + uint(v10.y) * g.x) >> 8);
    int south = int((uint(v01.y) * h.x + uint(v11.y) * g.x) >> 8);
    land.gain = uint(west + signed_product_shifted(east - west, f.x, 16)) << 1;
    precise vec2 gain_slope = vec2(float(east - west), float(south - north)) * per_step.y;
    land.gain_slope = gain_slope;
    return land;
}

// ---- the sum: sea.cpp ----

struct Local {
    uint shift;
    float g;     // gain
    vec2 slope;  // of the gain, 1/m
    vec2 turn;   // gradient of the shift, rad/m
};

float gain_to_float(uint gain) { return float(gain >> 2) * uintBitsToFloat(0x34800000u); }

Local combine(Envelope e, Land land) {
    precise float box_gain = gain_to_float(e.gain);
    precise float land_gain = gain_to_float(land.gain);
    precise vec2 slope = e.slope * land_gain + box_gain * land.gain_slope;
    return Local(land.shift, gain_to_float(product_shifted(e.gain, land.gain, 24)), slope, land.shift_slope);
}

// Accumulators; acc = (coefficient * value) + acc, each rounded on its own.
precise vec3 sum_a;     // (aX, aY, aZ), m
precise vec2 sum_b;
precise vec4 sum_m;     // mxx, mxz, mzx, mzz
float faded_variance;   // slope variance of what is not displayed
float total_variance;   // of the whole sea
float shown_height;     // sum of A * g of what is displayed, m
#ifdef TROCHOID_PROBE
uint phase_digest;      // of all phases in the order of the sum
#endif

void add_train(int row, Local l, uint phase, float weight) {
    vec4 c0 = intBitsToFloat(texelFetch(sea_records, row + 1));  // kx, kz, a, hx
    float hz = intBitsToFloat(texelFetch(sea_records, row + 2).x);
    float a = c0.z;
    float hx = c0.w;
    float wave_sin, wave_cos;
    sincos_turns(phase, wave_sin, wave_cos);
    precise float g = l.g * weight;
    precise float s = g * wave_sin;
    precise float c = g * wave_cos;
    precise float kx = c0.x + l.turn.x;
    precise float kz = c0.y + l.turn.y;
    sum_a = vec3(hx, a, hz) * vec3(s, c, s) + sum_a;
    sum_b = vec2(a * kx, a * kz) * s + sum_b;
    sum_m = vec4(hx * kx, hx * kz, hz * kx, hz * kz) * c + sum_m;
    if (l.slope.x != 0.0 || l.slope.y != 0.0) {
        precise vec2 d = l.slope * weight;
        sum_b = (a * -d) * wave_cos + sum_b;
        sum_m = vec4(hx * d.x, hx * d.y, hz * d.x, hz * d.y) * wave_sin + sum_m;
    }
    shown_height += a * g;
}

void add_box(ivec2 entry, ivec2 r, uvec2 place, float spacing) {
    int row = entry.x;
    Envelope e = envelope_at(row, r);
    if (e.gain == 0u) return;
    int trains = texelFetch(sea_records, row + 5).w;
    int first = texelFetch(sea_records, row + 6).z;
    Land open_water = Land(0u, full_gain, vec2(0.0), vec2(0.0));
    Local local = combine(e, open_water);
    int field = -1;
    float g2 = local.g * local.g;
    total_variance += g2 * intBitsToFloat(texelFetch(sea_records, first + 2).w);
    int shown = 0;
    for (; shown < entry.y; ++shown) {
        int train = first + shown * TRAIN_ROW;
        ivec4 wave = texelFetch(sea_records, train);
        if (wave.w != field) {
            field = wave.w;
            local = combine(e, field < 0 ? open_water : land_at(field, r));
        }
        float weight = 1.0;
        if (mesh_filter.z == 0.0) {
            vec3 tail = intBitsToFloat(texelFetch(sea_records, train + 2).yzw);
            weight = displayed_weight(tail.x, spacing);
            faded_variance += local.g * local.g * tail.y * (1.0 - weight * weight);
        }
        uint phase = uint(wave.x) * place.x + uint(wave.y) * place.y + uint(wave.z) + local.shift;
#ifdef TROCHOID_PROBE
        phase_digest = (phase_digest ^ phase) * 16777619u;
#endif
        if (weight <= 0.0) break;  // trains come by falling wavelength: all others fade too
        add_train(train, local, phase, weight);
    }
    // The one that ended the loop has counted itself already; those behind it, and what the server left out, follow.
    int rest = shown < entry.y ? shown + 1 : shown;
    if (rest < trains) faded_variance += local.g * local.g * intBitsToFloat(texelFetch(sea_records, first + rest * TRAIN_ROW + 2).w);
}

/// Sums the boxes of a list at a place relative to the anchor; the sums above hold the result.
void sum_sea(int list, ivec2 r, float spacing) {
    sum_a = vec3(0.0);
    sum_b = vec2(0.0);
    sum_m = vec4(0.0);
    faded_variance = 0.0;
    total_variance = 0.0;
    shown_height = 0.0;
#ifdef TROCHOID_PROBE
    phase_digest = 2166136261u;
#endif
    uvec2 place = uvec2(camera_cell.zw + r);
    int entries = texelFetch(sea_lists, list).x;
    for (int i = 1; i <= entries; ++i) add_box(texelFetch(sea_lists, list + i).xy, r, place, spacing);
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
