#include "client/scene/coherent_tree.hpp"

#include <cstdlib>

#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

constexpr int32_t cell_side = int32_t{1} << coherent_cell_log2;

bool has_cell(const CoherentWindow& window, int64_t x, int64_t z) {
    constexpr int64_t half = coherent_cells / 2;
    return x >= window.x - half && x < window.x + half && z >= window.z - half && z < window.z + half;
}

/// A cell's four triangles: north, west, south, east; the right angle in the middle.
void append_cell(std::vector<CoherentTriangle>& triangles, const CoherentWindow& window, int64_t x,
                 int64_t z) {
    const glm::ivec2 north_west(static_cast<int32_t>(x - window.x) * cell_side,
                                static_cast<int32_t>(z - window.z) * cell_side);
    const glm::ivec2 middle = north_west + cell_side / 2;
    const std::array<glm::ivec2, 4> around{north_west + glm::ivec2(cell_side, 0), north_west,
                                           north_west + glm::ivec2(0, cell_side), north_west + cell_side};
    const auto number =
        static_cast<uint64_t>((z & (coherent_cells - 1)) * coherent_cells + (x & (coherent_cells - 1)));
    for (size_t i = 0; i < 4; ++i)
        triangles.push_back({{around[i], around[(i + 1) % 4], middle}, number * 4 + i, 0});
}

CoherentTriangle child(const CoherentTriangle& parent, int pattern, int number, glm::ivec2 a, glm::ivec2 b,
                       glm::ivec2 c) {
    return {{a, b, c}, identity_of_child(parent.identity, number), path_of_child(parent.path, pattern)};
}

}  // namespace

CoherentWindow window_about(LatticePoint place) {
    constexpr int64_t half = cell_side / 2;
    return {(place.x + half) >> coherent_cell_log2, (place.z + half) >> coherent_cell_log2};
}

CoherentWindow window_about(LatticePoint place, const CoherentWindow& current) {
    constexpr int64_t reach = cell_side / 4 * 3;
    const LatticePoint middle = current.origin();
    if (std::abs(place.x - middle.x) <= reach && std::abs(place.z - middle.z) <= reach) return current;
    return window_about(place);
}

std::vector<CoherentTriangle> base_triangles(const CoherentWindow& window) {
    std::vector<CoherentTriangle> triangles;
    for (int64_t z = window.z - coherent_cells / 2; z < window.z + coherent_cells / 2; ++z)
        for (int64_t x = window.x - coherent_cells / 2; x < window.x + coherent_cells / 2; ++x)
            append_cell(triangles, window, x, z);
    return triangles;
}

std::vector<CoherentTriangle> base_triangles(const CoherentWindow& window, const CoherentWindow& without) {
    std::vector<CoherentTriangle> triangles;
    for (int64_t z = window.z - coherent_cells / 2; z < window.z + coherent_cells / 2; ++z)
        for (int64_t x = window.x - coherent_cells / 2; x < window.x + coherent_cells / 2; ++x)
            if (!has_cell(without, x, z)) append_cell(triangles, window, x, z);
    return triangles;
}

std::vector<CoherentTriangle> divided(const CoherentTriangle& t, int pattern) {
    const auto [a, b, c] = t.corners;
    const glm::ivec2 h = (a + b) >> 1;  // middle of the hypotenuse
    const glm::ivec2 f = (b + c) >> 1;  // of the first leg
    const glm::ivec2 s = (c + a) >> 1;  // of the second leg
    const auto make = [&](int number, glm::ivec2 p, glm::ivec2 q, glm::ivec2 r) {
        return child(t, pattern, number, p, q, r);
    };
    switch (pattern) {
        case 1: return {make(0, h, c, s), make(1, a, h, s), make(2, h, b, f), make(3, c, h, f)};
        case 2: return {make(0, s, f, c), make(1, a, b, f), make(2, a, f, s)};
        case 3: return {make(0, c, a, h), make(1, h, b, f), make(2, c, h, f)};
        case 4: return {make(0, a, b, f), make(1, a, f, c)};
        case 5: return {make(0, b, c, h), make(1, h, c, s), make(2, a, h, s)};
        case 6: return {make(0, a, b, s), make(1, s, b, c)};
        case 7: return {make(0, c, a, h), make(1, b, c, h)};
        default: break;
    }
    TROCHOID_ASSERT(false, "no pattern {}", pattern);
}

std::vector<CoherentTriangle> refined(const std::vector<CoherentTriangle>& base, const EdgeTest& wants_split,
                                      int most_levels) {
    std::vector<CoherentTriangle> done;
    for (const CoherentTriangle& t : base) {
        const auto [a, b, c] = t.corners;
        const int pattern =
            most_levels > 0 ? coherent_pattern(wants_split(a, b), wants_split(b, c), wants_split(c, a)) : 0;
        if (pattern == 0) {
            done.push_back(t);
            continue;
        }
        const std::vector<CoherentTriangle> below =
            refined(divided(t, pattern), wants_split, most_levels - 1);
        done.insert(done.end(), below.begin(), below.end());
    }
    return done;
}

}  // namespace trochoid
