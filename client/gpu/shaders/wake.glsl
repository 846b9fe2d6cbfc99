// A ship's wake: twin of ship_wake.cpp. Needs wide.glsl and sea_records. The tables' layout: wake_texels in sea_table.cpp.
uniform isamplerBuffer wake_nodes;  // RGBA32I: transverse nodes, diverging nodes (phase, along, outwards, gain), roots

const int wake_nodes_each = 769;
const uint wake_unit = 0x1000000u;

struct WakeWave {
    uint phase;       // turns, Q0.32
    uint gain;        // Q0.24
    vec2 gain_slope;  // 1/m along u and v
    vec2 k;           // rad/m
    vec2 d;           // unit direction
};

/// A factor of the gain and its slope per lambda0.
struct WakeFactor {
    uint gain;
    float slope;
};

int wake_between(int n0, int n1, uint fraction, int bits) { return n0 + signed_product_shifted(n1 - n0, int(fraction), bits); }

WakeFactor wake_smooth(uint q, float steepness) {
    uint square = times(q, q);
    precise float f = unit(q);
    precise float slope = steepness * ((6.0 * f) * (1.0 - f));
    return WakeFactor(times(square, 3u * wake_unit - 2u * q), slope);
}

/// min((length * inverse) >> shift, 1), Q0.24; 0 for lengths below 0.
uint wake_ramp(int length, uint inverse, int shift) {
    if (length <= 0) return 0u;
    uint high, low;
    umulExtended(uint(length), inverse, high, low);
    if ((high >> shift) != 0u) return wake_unit;
    return min((high << (32 - shift)) | (low >> shift), wake_unit);
}

/// 1/sqrt(xi) from xi = 1 on, a straight line towards 3/2 before. xi: Q.20.
WakeFactor wake_fall(uint xi) {
    if (xi < 0x100000u) return WakeFactor((3u * wake_unit - (xi << 4)) >> 1, -0.5);
    int halvings = (findMSB(xi) - 20) / 2;
    uint m = xi >> (2 * halvings);
    int cell = 2 * wake_nodes_each + int((m - 0x100000u) >> 15);
    int n0 = texelFetch(wake_nodes, cell).x;
    int n1 = texelFetch(wake_nodes, cell + 1).x;
    precise float slope = float(n1 - n0) * power_of_two(-19 - 3 * halvings);
    return WakeFactor(uint(wake_between(n0, n1, m & 32767u, 15)) >> halvings, slope);
}

/// What both systems share at a point.
struct WakePlace {
    uint distance_high;  // behind / lambda0, Q.40
    uint distance_low;
    uint tau;            // Q0.24; all ones: no wake here
    float side;
    float per_metre;     // 1 / behind
    float inverse;       // 1 / lambda0, 1/m
    float k0;            // 2 pi / lambda0
    WakeFactor fall;
    WakeFactor rise;
    WakeFactor end;
};

WakePlace wake_place(int row, int u, int v) {
    WakePlace at;
    at.tau = 0xffffffffu;
    ivec4 first = texelFetch(sea_records, row);
    int behind = first.y - u;
    int aside = v - first.z;
    int off = abs(aside);
    if (behind <= 0 || off >= behind) return at;
    int excess = findMSB(uint(behind)) - 23;
    uint b = excess >= 0 ? uint(behind) >> excess : uint(behind) << -excess;
    uint a = excess >= 0 ? uint(off) >> excess : uint(off) << -excess;
    uint tau = quotient24(a, b);
    if (tau >= 768u << 13) return at;
    ivec4 second = texelFetch(sea_records, row + 1);
    precise float per_metre = float(quotient24(0x800000u, b)) * power_of_two(-37 - excess);
    at.per_metre = per_metre;
    at.side = aside < 0 ? -1.0 : 1.0;
    at.inverse = intBitsToFloat(second.w);
    at.k0 = intBitsToFloat(texelFetch(sea_records, row + 2).z);
    uint inverse_length = uint(first.x);
    umulExtended(uint(behind), inverse_length, at.distance_high, at.distance_low);
    at.fall = wake_fall((at.distance_high >> 20) != 0u ? 0xffffffffu : (at.distance_high << 12) | (at.distance_low >> 20));
    at.rise = wake_smooth(wake_ramp(behind - second.x, inverse_length, 17), 0.5);
    at.end = wake_smooth(wake_ramp(first.w - behind, inverse_length, 16), -1.0);
    at.tau = tau;
    return at;
}

WakeWave wake_wave(int nodes, WakePlace at, uint lag) {
    int cell = nodes + int(at.tau >> 13);
    uint fraction = at.tau & 8191u;
    ivec4 n0 = texelFetch(wake_nodes, cell);
    ivec4 n1 = texelFetch(wake_nodes, cell + 1);
    WakeWave w = WakeWave(0u, 0u, vec2(0.0), vec2(0.0), vec2(0.0));
    uint gain = uint(wake_between(n0.w, n1.w, fraction, 13));
    w.gain = times(times(times(gain, at.fall.gain), at.rise.gain), at.end.gain);
    if (w.gain == 0u) return w;
    uint turns = uint(wake_between(n0.x, n1.x, fraction, 13));
    uint high, low;
    umulExtended(at.distance_low, turns, high, low);
    w.phase = lag - (at.distance_high * turns + high);
    precise float tau = unit(at.tau);
    precise float phase = gain_to_float(turns);
    precise float phase_slope = float(n1.x - n0.x) * uintBitsToFloat(0x39000000u);
    precise float ku = at.k0 * (phase - tau * phase_slope);
    precise float kv = at.side * -(at.k0 * phase_slope);
    w.k = vec2(ku, kv);
    precise float du = float(wake_between(n0.y, n1.y, fraction, 13)) * uintBitsToFloat(0x33800000u);
    precise float dv = at.side * (float(wake_between(n0.z, n1.z, fraction, 13)) * uintBitsToFloat(0x33800000u));
    w.d = vec2(du, dv);

    precise float g = gain_to_float(gain);
    precise float gain_slope = float(n1.w - n0.w) * uintBitsToFloat(0x39000000u);
    precise float fall = gain_to_float(at.fall.gain);
    precise float rise = gain_to_float(at.rise.gain);
    precise float end = gain_to_float(at.end.gain);
    precise float stand = rise * end;
    precise float by_tau = (gain_slope * at.per_metre) * (fall * stand);
    precise float by_distance =
        at.inverse * (g * (at.fall.slope * stand + fall * (at.rise.slope * end + rise * at.end.slope)));
    precise float slope_u = by_tau * tau - by_distance;
    precise float slope_v = at.side * by_tau;
    w.gain_slope = vec2(slope_u, slope_v);
    return w;
}
