#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>

namespace trochoid {

/// Four float32 in one register; every operation element by element, each rounded on its own, on any machine.
using FourFloats __attribute__((vector_size(16))) = float;

/// Two values of one point.
struct ValuePair {
    float first;
    float second;
};

/// Bilinear between four points of a plane of interleaved pairs: `north` points at the north-west point's, `south` at the
/// south-west point's; fx and fz in [0, 1]. Equal values stay exactly equal.
inline ValuePair bilinear(const float* north, const float* south, float fx, float fz) {
    FourFloats a;
    FourFloats b;
    std::memcpy(&a, north, sizeof a);
    std::memcpy(&b, south, sizeof b);
    const FourFloats v = a + (b - a) * fz;
    return {v[0] + (v[2] - v[0]) * fx, v[1] + (v[3] - v[1]) * fx};
}

/// Asks for what the next row reads: oblique rows touch a new page every few points, which no hardware foresees. Harmless beyond the
/// end of a plane.
inline void prefetch(const float* at) { __builtin_prefetch(at); }

/// Q.32 of a value below 2^31, towards zero.
inline int64_t to_q32(double value) { return static_cast<int64_t>(value * 0x1p32); }
/// The fraction of a Q.32 number to 24 bits, exact in float32.
inline float fraction_of(int64_t q32) {
    return static_cast<float>(static_cast<int32_t>(static_cast<uint32_t>(q32) >> 8)) * 0x1p-24F;
}

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
