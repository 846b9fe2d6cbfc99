// Vectors of one instruction set; compiled once for each (Highway's foreach_target).
#if defined(TROCHOID_SIMD_VECTORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TROCHOID_SIMD_VECTORS_INL
#undef TROCHOID_SIMD_VECTORS_INL
#else
#define TROCHOID_SIMD_VECTORS_INL
#endif

#include <hwy/highway.h>

#include "protocol/model/sincos.hpp"

HWY_BEFORE_NAMESPACE();
namespace trochoid::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using TagF = hn::ScalableTag<float>;
using TagU = hn::ScalableTag<uint32_t>;
using TagI = hn::ScalableTag<int32_t>;
using VecF = hn::Vec<TagF>;
using VecU = hn::Vec<TagU>;
using VecI = hn::Vec<TagI>;
constexpr TagF df;
constexpr TagU du;
constexpr TagI di;
constexpr size_t lanes = HWY_LANES(float);

HWY_INLINE VecF splat(float v) { return hn::Set(df, v); }
HWY_INLINE VecF splat_bits(uint32_t bits) { return hn::BitCast(df, hn::Set(du, bits)); }
HWY_INLINE VecF mul(VecF a, VecF b) { return hn::Mul(a, b); }
HWY_INLINE VecF add(VecF a, VecF b) { return hn::Add(a, b); }
HWY_INLINE VecF sub(VecF a, VecF b) { return hn::Sub(a, b); }
/// The ordered sum's step, each rounded on its own.
HWY_INLINE void accumulate(VecF& acc, VecF coefficient, VecF value) {
    acc = add(mul(coefficient, value), acc);
}
HWY_INLINE VecF float_of(VecU v) { return hn::ConvertTo(df, hn::BitCast(di, v)); }

/// A phase on its way to sine and cosine: the polynomials' argument and its square, and the octant's bits.
struct Angle {
    VecF t, z;
    VecU q;
};
HWY_INLINE Angle angle_of(VecU phase) {
    const VecI r = hn::ShiftRight<8>(hn::BitCast(di, hn::ShiftLeft<2>(phase)));
    const VecF t = mul(hn::ConvertTo(df, r), splat(0x1p-23F));
    return {t, mul(t, t), hn::Add(phase, hn::Set(du, 0x20000000U))};
}

/// Sine and cosine.
struct Wave {
    VecF sine, cosine;
};
HWY_INLINE Wave wave_of(const Angle& angle) {
    namespace k = sincos_bits;
    const VecF z = angle.z;
    const VecF sine =
        mul(angle.t,
            add(splat_bits(k::s1),
                mul(z, add(splat_bits(k::s3), mul(z, add(splat_bits(k::s5), mul(z, splat_bits(k::s7))))))));
    const VecF cosine =
        add(splat(1.0F),
            mul(z, add(splat_bits(k::c2), mul(z, add(splat_bits(k::c4), mul(z, splat_bits(k::c6)))))));
    const VecU sign = hn::Set(du, 0x80000000U);
    const VecU sine_sign = hn::And(angle.q, sign);
    const VecU cosine_sign = hn::And(hn::Add(angle.q, hn::Set(du, 0x40000000U)), sign);
#if HWY_TARGET != HWY_AVX2 && HWY_TARGET != HWY_SSE4
    const auto swapped = hn::RebindMask(df, hn::TestBit(angle.q, hn::Set(du, 0x40000000U)));
    const VecF s = hn::IfThenElse(swapped, cosine, sine);
    const VecF c = hn::IfThenElse(swapped, sine, cosine);
#else
    // Bit 30 moved into the sign, which is all that these targets' blends look at.
    const VecF swapped = hn::BitCast(df, hn::ShiftLeft<1>(angle.q));
    const VecF s = hn::IfNegativeThenElse(swapped, cosine, sine);
    const VecF c = hn::IfNegativeThenElse(swapped, sine, cosine);
#endif
    return {hn::BitCast(df, hn::Xor(hn::BitCast(du, s), sine_sign)),
            hn::BitCast(df, hn::Xor(hn::BitCast(du, c), cosine_sign))};
}

/// sincos_turns, every lane.
HWY_INLINE Wave wave_of(VecU phase) { return wave_of(angle_of(phase)); }

/// Low 32 bits of (a * b) >> shift, the product in 64 bits, every lane unsigned.
template <int shift>
HWY_INLINE VecU mul_shift(VecU a, VecU b) {
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
    HWY_ALIGN uint32_t x[lanes];
    HWY_ALIGN uint32_t y[lanes];
    hn::Store(a, du, x);
    hn::Store(b, du, y);
    for (size_t i = 0; i < lanes; ++i)
        x[i] = static_cast<uint32_t>((static_cast<uint64_t>(x[i]) * y[i]) >> shift);
    return hn::Load(du, x);
#else
    const hn::Repartition<uint64_t, TagU> dw;
    const auto odd = [&](VecU v) HWY_ATTR { return hn::BitCast(du, hn::ShiftRight<32>(hn::BitCast(dw, v))); };
    const auto even_product = hn::MulEven(a, b);
    const auto odd_product = hn::MulEven(odd(a), odd(b));
    return hn::OddEven(hn::BitCast(du, hn::ShiftLeft<32 - shift>(odd_product)),
                       hn::BitCast(du, hn::ShiftRight<shift>(even_product)));
#endif
}

/// (a * b) >> 16 for a below 2^31 in size and b in [0, 65535]; the result has to fit in 32 bits.
HWY_INLINE VecI scale16(VecI a, VecI b) {
    const VecI high = hn::Mul(hn::ShiftRight<16>(a), b);
    const VecU low = hn::Mul(hn::And(hn::BitCast(du, a), hn::Set(du, 0xffffU)), hn::BitCast(du, b));
    return hn::Add(high, hn::BitCast(di, hn::ShiftRight<16>(low)));
}

template <class T, class D>
HWY_INLINE hn::Vec<D> load(D d, const T* from) {
    return hn::Load(d, from);
}

}  // namespace trochoid::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
