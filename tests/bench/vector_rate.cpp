#include "tests/bench/vector_rate.hpp"

#include "protocol/model/simd/highway.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/vector_rate.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace trochoid::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class V>
HWY_INLINE void opaque(V& v) {
#if HWY_TARGET == HWY_AVX3
    asm volatile("" : "+v"(v.raw));
#elif HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR
    asm volatile("" : "+x"(v.raw));
#else
    (void)v;
#endif
}

int64_t VectorWork(int64_t count) {
    const hn::ScalableTag<float> d;
    auto m0 = hn::Set(d, 1.0F);
    auto m1 = m0;
    auto m2 = m0;
    auto m3 = m0;
    auto m4 = m0;
    auto m5 = m0;
    auto a0 = m0;
    auto a1 = m0;
    auto a2 = m0;
    auto a3 = m0;
    auto a4 = m0;
    auto a5 = m0;
    const auto by = hn::Set(d, 0.999999F);
    const int64_t rounds = count / 24;
    for (int64_t i = 0; i < rounds; ++i) {
        // Sixfold both ways, so that no chain of results is waited for; the barriers keep each operation.
        for (int twice = 0; twice < 2; ++twice) {
            m0 = hn::Mul(m0, by);
            a0 = hn::Add(a0, by);
            m1 = hn::Mul(m1, by);
            a1 = hn::Add(a1, by);
            m2 = hn::Mul(m2, by);
            a2 = hn::Add(a2, by);
            m3 = hn::Mul(m3, by);
            a3 = hn::Add(a3, by);
            m4 = hn::Mul(m4, by);
            a4 = hn::Add(a4, by);
            m5 = hn::Mul(m5, by);
            a5 = hn::Add(a5, by);
            opaque(m0);
            opaque(m1);
            opaque(m2);
            opaque(m3);
            opaque(m4);
            opaque(m5);
            opaque(a0);
            opaque(a1);
            opaque(a2);
            opaque(a3);
            opaque(a4);
            opaque(a5);
        }
    }
    return rounds * 24;
}

int VectorWidth() { return static_cast<int>(HWY_LANES(float)); }

}  // namespace trochoid::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trochoid::bench {

HWY_EXPORT(VectorWork);
HWY_EXPORT(VectorWidth);

int64_t vector_work(int64_t count) { return HWY_DYNAMIC_DISPATCH(VectorWork)(count); }
int vector_width() { return HWY_DYNAMIC_DISPATCH(VectorWidth)(); }

}  // namespace trochoid::bench
#endif
