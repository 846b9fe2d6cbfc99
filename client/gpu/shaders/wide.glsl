// Sines by phase and integers wider than 32 bits: sincos.hpp and the int64 of the model.

void sincos_turns(uint phase, out float sine_out, out float cosine_out) {
    // Coefficients as bits: a decimal may be read another way.
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

float power_of_two(int exponent) { return uintBitsToFloat(uint(127 + exponent) << 23); }

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

/// (a << 24) / b for a <= b, 2^23 <= b < 2^24: 32 bits never overflow in steps of eight.
uint quotient24(uint a, uint b) {
    uint q = a / b;
    uint rest = a - q * b;
    for (int i = 0; i < 3; ++i) {
        rest <<= 8;
        uint digit = rest / b;
        rest -= digit * b;
        q = (q << 8) | digit;
    }
    return q;
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

/// Gains, Q0.24: as floats, and their product.
float unit(uint gain) { return float(gain) * uintBitsToFloat(0x33800000u); }
uint times(uint a, uint b) { return product_shifted(a, b, 24); }
/// Gains below 2^26 by their upper 24 bits, exactly.
float gain_to_float(uint gain) { return float(gain >> 2) * uintBitsToFloat(0x34800000u); }
