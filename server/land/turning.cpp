#include "server/land/turning.hpp"

#include <algorithm>
#include <cstring>

#include "server/land/bilinear.hpp"

namespace trochoid {

namespace {

using EightShorts __attribute__((vector_size(16))) = uint16_t;

template <class Vector>
Vector load(const void* from) {
    Vector out;
    std::memcpy(&out, from, sizeof out);
    return out;
}

struct FourRows {
    FourFloats a;
    FourFloats b;
    FourFloats c;
    FourFloats d;
};

/// Four rows of four values to columns; nothing is computed, so the values may be of any kind.
inline FourRows turned(const FourRows& in) {
    const FourFloats ab_west = shuffled<0, 4, 1, 5>(in.a, in.b);
    const FourFloats ab_east = shuffled<2, 6, 3, 7>(in.a, in.b);
    const FourFloats cd_west = shuffled<0, 4, 1, 5>(in.c, in.d);
    const FourFloats cd_east = shuffled<2, 6, 3, 7>(in.c, in.d);
    return {shuffled<0, 1, 4, 5>(ab_west, cd_west), shuffled<2, 3, 6, 7>(ab_west, cd_west),
            shuffled<0, 1, 4, 5>(ab_east, cd_east), shuffled<2, 3, 6, 7>(ab_east, cd_east)};
}

/// Values of four bytes, four by four.
template <class Value>
inline void turn_four(const Value* from, size_t pitch, Value* to, size_t to_pitch) {
    static_assert(sizeof(Value) == sizeof(float));
    const FourRows out = turned({load<FourFloats>(from), load<FourFloats>(from + pitch),
                                 load<FourFloats>(from + 2 * pitch), load<FourFloats>(from + 3 * pitch)});
    std::memcpy(to, &out.a, sizeof out.a);
    std::memcpy(to + to_pitch, &out.b, sizeof out.b);
    std::memcpy(to + 2 * to_pitch, &out.c, sizeof out.c);
    std::memcpy(to + 3 * to_pitch, &out.d, sizeof out.d);
}

/// The values of two rows in turn: columns 0 to 3, and 4 to 7.
struct Woven {
    FourFloats west;
    FourFloats east;
};
inline Woven woven(const uint16_t* upper, const uint16_t* lower) {
    const auto a = load<EightShorts>(upper);
    const auto b = load<EightShorts>(lower);
#if defined(__clang__) || __GNUC__ >= 12
    const EightShorts west = __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
    const EightShorts east = __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
#else
    const EightShorts west = __builtin_shuffle(a, b, EightShorts{0, 8, 1, 9, 2, 10, 3, 11});
    const EightShorts east = __builtin_shuffle(a, b, EightShorts{4, 12, 5, 13, 6, 14, 7, 15});
#endif
    return {load<FourFloats>(&west), load<FourFloats>(&east)};
}

/// Eight by eight: pairs of rows as values of four bytes.
inline void turn_eight(const uint16_t* from, size_t pitch, uint16_t* to, size_t to_pitch) {
    const Woven a = woven(from, from + pitch);
    const Woven b = woven(from + 2 * pitch, from + 3 * pitch);
    const Woven c = woven(from + 4 * pitch, from + 5 * pitch);
    const Woven d = woven(from + 6 * pitch, from + 7 * pitch);
    const FourRows west = turned({a.west, b.west, c.west, d.west});
    const FourRows east = turned({a.east, b.east, c.east, d.east});
    size_t row = 0;
    for (const FourRows& rows : {west, east})
        for (const FourFloats& values : {rows.a, rows.b, rows.c, rows.d})
            std::memcpy(to + row++ * to_pitch, &values, sizeof values);
}

/// Last row and column of a block.
template <class Value>
void turn_edges(const Value* from, size_t pitch, Value* to) {
    constexpr size_t last = block_nodes - 1;
    for (size_t i = 0; i < block_nodes; ++i) {
        to[i * block_nodes + last] = from[last * pitch + i];
        to[last * block_nodes + i] = from[i * pitch + last];
    }
}

}  // namespace

std::vector<float> turned(std::span<const float> values, size_t nx, size_t nz) {
    // Tile by tile, so that both sides stay in the cache.
    constexpr size_t tile = 32;
    std::vector<float> out(values.size());
    for (size_t z0 = 0; z0 < nz; z0 += tile)
        for (size_t x0 = 0; x0 < nx; x0 += tile) {
            const size_t x1 = std::min(x0 + tile, nx);
            const size_t z1 = std::min(z0 + tile, nz);
            for (size_t x = x0; x < x1; x += 4)
                for (size_t z = z0; z < z1; z += 4) {
                    if (x + 4 <= x1 && z + 4 <= z1) {
                        turn_four(values.data() + z * nx + x, nx, out.data() + x * nz + z, nz);
                        continue;
                    }
                    for (size_t i = x; i < std::min(x + 4, x1); ++i)
                        for (size_t j = z; j < std::min(z + 4, z1); ++j) out[i * nz + j] = values[j * nx + i];
                }
        }
    return out;
}

void turn_block(const int32_t* from, size_t pitch, int32_t* to) {
    for (size_t x = 0; x < block_cells; x += 4)
        for (size_t z = 0; z < block_cells; z += 4)
            turn_four(from + z * pitch + x, pitch, to + x * block_nodes + z, block_nodes);
    turn_edges(from, pitch, to);
}

void turn_block(const uint16_t* from, size_t pitch, uint16_t* to) {
    for (size_t x = 0; x < block_cells; x += 8)
        for (size_t z = 0; z < block_cells; z += 8)
            turn_eight(from + z * pitch + x, pitch, to + x * block_nodes + z, block_nodes);
    turn_edges(from, pitch, to);
}

}  // namespace trochoid
