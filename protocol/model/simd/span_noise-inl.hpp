// Surface noise over a span: surface_noise.cpp's octave_at and SeaInstant's add_noise, many points at once.
#if defined(TROCHOID_SIMD_NOISE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TROCHOID_SIMD_NOISE_INL
#undef TROCHOID_SIMD_NOISE_INL
#else
#define TROCHOID_SIMD_NOISE_INL
#endif

#include "protocol/model/simd/span_shape-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace trochoid::simd::HWY_NAMESPACE {

/// A noise value with its derivatives per cell. Never without initial values: on Arm the constructor that gcc makes for itself
/// has the command line's target, and cannot take in that of a vector.
struct Jet {
    VecF value, dx, dz, dt;
};
HWY_INLINE Jet no_noise() { return {hn::Zero(df), hn::Zero(df), hn::Zero(df), hn::Zero(df)}; }

HWY_INLINE VecU mix(VecU v) {
    v = hn::Mul(hn::Xor(v, hn::ShiftRight<16>(v)), hn::Set(du, 0x7feb352dU));
    v = hn::Mul(hn::Xor(v, hn::ShiftRight<15>(v)), hn::Set(du, 0x846ca68bU));
    return hn::Xor(v, hn::ShiftRight<16>(v));
}

/// One of the sixteen gradients, by the hash's top four bits: two signs and the choice of components.
HWY_INLINE Jet corner(VecU hash, VecF fx, VecF fz, VecF ft) {
    const VecU sign = hn::Set(du, 0x80000000U);
    const VecU one = hn::BitCast(du, splat(1.0F));
    const VecF first = hn::BitCast(df, hn::Xor(one, hn::And(hn::ShiftLeft<3>(hash), sign)));
    const VecF second = hn::BitCast(df, hn::Xor(one, hn::And(hn::ShiftLeft<2>(hash), sign)));
    const VecU pair = hn::ShiftRight<30>(hash);
    const auto is_1 = hn::RebindMask(df, hn::Eq(pair, hn::Set(du, 1U)));
    const auto is_2 = hn::RebindMask(df, hn::Eq(pair, hn::Set(du, 2U)));
    const VecF dx = hn::IfThenZeroElse(is_2, first);
    const VecF dz = hn::IfThenZeroElse(is_1, hn::IfThenElse(is_2, first, second));
    const VecF dt = hn::IfThenElseZero(hn::Or(is_1, is_2), second);
    return {add(add(mul(dx, fx), mul(dz, fz)), mul(dt, ft)), dx, dz, dt};
}

HWY_INLINE VecF blend(VecF a, VecF b, VecF w) { return add(a, mul(w, sub(b, a))); }
HWY_INLINE Jet blend(const Jet& a, const Jet& b, VecF w) {
    return {blend(a.value, b.value, w), blend(a.dx, b.dx, w), blend(a.dz, b.dz, w), blend(a.dt, b.dt, w)};
}

HWY_INLINE VecF fade(VecF f) {
    const VecF inner = add(mul(f, sub(mul(f, splat(6.0F)), splat(15.0F))), splat(10.0F));
    return mul(mul(mul(f, f), f), inner);
}
HWY_INLINE VecF fade_slope(VecF f) {
    const VecF before = sub(f, splat(1.0F));
    return mul(mul(splat(30.0F), mul(f, f)), mul(before, before));
}

/// Where the points are in the cells of an octave, along one axis.
struct AxisCells {
    VecU hash[2];  ///< of the cell's two lattice lines
    VecF at;       ///< [0, 1)
};
HWY_INLINE AxisCells cells_of(VecU place, const NoiseOctave& o, uint32_t factor) {
    const VecU cell = hn::ShiftRightSame(place, o.step_log2);
    const VecU next = hn::And(hn::Add(cell, hn::Set(du, 1U)), hn::Set(du, 0xffffffffU >> o.step_log2));
    const VecU rest = hn::And(place, hn::Set(du, (1U << o.step_log2) - 1U));
    return {{hn::Mul(cell, hn::Set(du, factor)), hn::Mul(next, hn::Set(du, factor))},
            mul(float_of(rest), splat_bits((127U - o.step_log2) << 23))};
}

HWY_INLINE Jet octave_at(const NoiseOctave& o, VecU px, VecU pz) {
    const AxisCells x = cells_of(px, o, 0x8da6b343U);
    const AxisCells z = cells_of(pz, o, 0xd8163841U);
    const VecF one = splat(1.0F);
    const VecF wx = fade(x.at);
    const VecF wz = fade(z.at);
    const VecF sx = fade_slope(x.at);
    const VecF sz = fade_slope(z.at);
    Jet layers[2] = {no_noise(), no_noise()};
    for (int t = 0; t < 2; ++t) {
        Jet rows[2] = {no_noise(), no_noise()};
        for (int r = 0; r < 2; ++r) {
            const VecU base = hn::Add(hn::Set(du, t == 0 ? o.early : o.late), z.hash[r]);
            const VecF at_z = r == 0 ? z.at : sub(z.at, one);
            const VecF at_t = splat(t == 0 ? o.since : o.since - 1.0F);
            const Jet west = corner(mix(hn::Add(base, x.hash[0])), x.at, at_z, at_t);
            const Jet east = corner(mix(hn::Add(base, x.hash[1])), sub(x.at, one), at_z, at_t);
            rows[r] = blend(west, east, wx);
            rows[r].dx = add(rows[r].dx, mul(sx, sub(east.value, west.value)));
        }
        layers[t] = blend(rows[0], rows[1], wz);
        layers[t].dz = add(layers[t].dz, mul(sz, sub(rows[1].value, rows[0].value)));
    }
    Jet out = blend(layers[0], layers[1], splat(o.fade));
    out.dt = add(out.dt, mul(splat(o.fade_slope), sub(layers[1].value, layers[0].value)));
    return out;
}

/// Adds a box's noise to the sums. Points without gain add 0, which changes no bit.
inline void add_noise_span(const PlannedBox& box, Scratch& at, int n) {
    const SpanEnvelope& e = at.envelope;
    SpanSums& m = at.sums;
    for (size_t i = 0; i < static_cast<size_t>(n); i += lanes) {
        const VecU gain = hn::Load(du, &e.gain[i]);
        if (hn::AllTrue(du, hn::Eq(gain, hn::Zero(du)))) continue;
        Jet sum = no_noise();
        for (const NoiseOctave& o : box.live->noise) {
            const Jet j = octave_at(o, hn::Load(du, &at.x_low[i]), hn::Load(du, &at.z_low[i]));
            accumulate(sum.value, splat(o.height), j.value);
            accumulate(sum.dx, splat(o.slope), j.dx);
            accumulate(sum.dz, splat(o.slope), j.dz);
            accumulate(sum.dt, splat(o.rate), j.dt);
        }
        const VecF g = gain_to_float(gain);
        const auto add_to = [i](SpanOf<float>& acc, VecF coefficient, VecF value) HWY_ATTR {
            VecF v = hn::Load(df, &acc[i]);
            accumulate(v, coefficient, value);
            hn::Store(v, df, &acc[i]);
        };
        add_to(m.ay, g, sum.value);
        add_to(m.bx, hn::Neg(g), sum.dx);
        add_to(m.bz, hn::Neg(g), sum.dz);
        add_to(m.bx, hn::Neg(hn::Load(df, &e.dx[i])), sum.value);
        add_to(m.bz, hn::Neg(hn::Load(df, &e.dz[i])), sum.value);
        add_to(m.vy, g, sum.dt);
    }
}

}  // namespace trochoid::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
