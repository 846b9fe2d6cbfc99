#pragma once
#include <algorithm>
#include <cstddef>
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

/// Eight float32, likewise. Not for arguments and results: how those are passed depends on the machine.
using EightFloats __attribute__((vector_size(32))) = float;
using EightInts __attribute__((vector_size(32))) = int32_t;

/// out = elements of a (0 to 7) and b (8 to 15) in another order.
template <int... order>
inline void shuffle(const EightFloats& a, const EightFloats& b, EightFloats& out) {
#if defined(__clang__) || __GNUC__ >= 12
    out = __builtin_shufflevector(a, b, order...);
#else
    out = __builtin_shuffle(a, b, EightInts{order...});
#endif
}

/// out = the pairs of values at at(a), at(b), at(c), at(d), one after the other.
template <class At>
inline void take_pairs(const At& at, size_t a, size_t b, size_t c, size_t d, EightFloats& out) {
    using FourDoubles __attribute__((vector_size(32))) = double;
    const auto pair = [&](size_t i) {
        double both = 0.0;
        std::memcpy(&both, at(i), sizeof both);
        return both;
    };
    const FourDoubles pairs = {pair(a), pair(b), pair(c), pair(d)};
    // Not by memcpy: gcc 12 would send it through memory.
    out = reinterpret_cast<EightFloats>(pairs);
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
