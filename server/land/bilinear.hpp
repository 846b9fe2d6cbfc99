#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>

namespace trochoid {

/// Four float32 in one register; every operation element by element, each rounded on its own, on any machine.
using FourFloats __attribute__((vector_size(16))) = float;

/// Four int32 in one register.
using FourInts __attribute__((vector_size(16))) = int32_t;

/// Elements of a (0 to 3) and b (4 to 7) in another order.
template <int A, int B, int C, int D>
inline FourFloats shuffled(FourFloats a, FourFloats b) {
#if defined(__clang__) || __GNUC__ >= 12
    return __builtin_shufflevector(a, b, A, B, C, D);
#else
    return __builtin_shuffle(a, b, FourInts{A, B, C, D});
#endif
}

/// Two pairs of values: first[0], first[1], second[0], second[1].
inline FourFloats two_pairs(const float* first, const float* second) {
    using TwoDoubles __attribute__((vector_size(16))) = double;
    double low = 0.0;
    double high = 0.0;
    std::memcpy(&low, first, sizeof low);
    std::memcpy(&high, second, sizeof high);
    const TwoDoubles both = {low, high};
    FourFloats out;
    std::memcpy(&out, &both, sizeof out);
    return out;
}

/// Asks for what the next row reads: oblique rows touch a new page every few points, which no hardware foresees. Harmless beyond the
/// end of a plane.
inline void prefetch(const float* at) { __builtin_prefetch(at); }

/// Q.32 of a value below 2^31, towards zero.
inline int64_t to_q32(double value) { return static_cast<int64_t>(value * 0x1p32); }

/// Whole numbers j in [from, to).
struct IndexRange {
    int32_t from = 0;
    int32_t to = 0;
};

/// The j in `within` for which start + j * step lies in [0, limit); all Q.32, |start|, limit < 2^54.
inline IndexRange indices_inside(IndexRange within, int64_t start, int64_t step, int64_t limit) {
    const auto floored = [](int64_t a, int64_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); };
    int64_t from = within.from;
    int64_t to = within.to;
    if (step == 0) {
        if (start < 0 || start >= limit) to = from;
    } else if (step > 0) {
        from = std::max(from, floored(-start - 1, step) + 1);
        to = std::min(to, floored(limit - start - 1, step) + 1);
    } else {
        from = std::max(from, floored(start - limit, -step) + 1);
        to = std::min(to, floored(start, -step) + 1);
    }
    return {static_cast<int32_t>(std::min<int64_t>(from, within.to)),
            static_cast<int32_t>(std::max<int64_t>(std::min<int64_t>(from, within.to), to))};
}

}  // namespace trochoid
