#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <vector>

#include "protocol/units/lattice.hpp"

namespace trochoid {

// Paper D's edge-based tessellation (Ripolles et al. 2014, section 3) on integer lattice points: its numbers, its base mesh, and
// the slow, obvious refinement that shaders/coherent_update.geom is compared with.

/// A right triangle or what refinement made of it: hypotenuse from corner 0 to 1, legs from 1 to 2 and from 2 to 0. Lattice
/// units relative to the mesh's origin. This is the record that the GPU keeps.
struct CoherentTriangle {
    std::array<glm::ivec2, 3> corners{};
    uint64_t identity = 0;  ///< I of eq. 1: unique in a mesh
    uint64_t path = 0;      ///< P of eq. 2: the patterns that led here, the last one lowest
    bool operator==(const CoherentTriangle&) const = default;
};
static_assert(sizeof(CoherentTriangle) == 40);

/// The paper's delta, gamma, alpha.
inline constexpr uint64_t coherent_most_children = 4;
inline constexpr uint64_t coherent_roots = 256;
inline constexpr uint64_t coherent_patterns = 7;
/// P of 22 levels fits in 64 bits.
inline constexpr int coherent_most_levels = 22;

/// Base mesh: 8 x 8 cells of 16 km, four triangles each about the cell's middle, which is 256 as in the paper. After 22 levels
/// every midpoint is still a lattice point.
inline constexpr int coherent_cell_log2 = 24;
inline constexpr int coherent_cells = 8;

/// Pattern for the edges that are split, 1 to 7, 0 = none. 1 splits all three; 2, 4 and 6 spare the hypotenuse (those that
/// the paper mends): 2 splits both legs, 4 the first, 6 the second; 7 splits the hypotenuse alone, 3 with the first leg, 5
/// with the second.
constexpr int coherent_pattern(bool hypotenuse, bool first_leg, bool second_leg) {
    const int edges = (hypotenuse ? 1 : 0) + (second_leg ? 2 : 0) + (first_leg ? 4 : 0);
    return edges == 0 ? 0 : 8 - edges;
}
/// Triangles that a pattern makes of one.
constexpr int coherent_children(int pattern) {
    return pattern == 1 ? 4 : (pattern == 2 || pattern == 3 || pattern == 5 ? 3 : 2);
}

/// Eq. 1 to 6, with the pattern taken as ((P - 1) mod 7) + 1: P mod 7 of eq. 4 is 0 for pattern 7.
constexpr uint64_t identity_of_child(uint64_t identity, int child) {
    return identity * coherent_most_children + coherent_roots + static_cast<uint64_t>(child);
}
constexpr uint64_t path_of_child(uint64_t path, int pattern) {
    return path * coherent_patterns + static_cast<uint64_t>(pattern);
}
constexpr bool is_root(uint64_t identity) { return identity < coherent_roots; }
constexpr int child_of(uint64_t identity) {
    return static_cast<int>((identity - coherent_roots) % coherent_most_children);
}
constexpr uint64_t identity_of_parent(uint64_t identity) {
    return (identity - coherent_roots) / coherent_most_children;
}
constexpr int last_pattern(uint64_t path) { return static_cast<int>((path - 1) % coherent_patterns) + 1; }
constexpr uint64_t path_of_parent(uint64_t path) { return (path - 1) / coherent_patterns; }
/// Refinements above a triangle.
constexpr int coherent_level(uint64_t identity) {
    int level = 0;
    for (; !is_root(identity); identity = identity_of_parent(identity)) ++level;
    return level;
}

/// Corner that the middle four cells share, in cells.
struct CoherentWindow {
    int64_t x = 0;
    int64_t z = 0;
    bool operator==(const CoherentWindow&) const = default;
    /// The mesh's origin.
    LatticePoint origin() const { return {x << coherent_cell_log2, z << coherent_cell_log2}; }
};
/// The window about a place: the nearest corner, or the current one as long as the place is within three quarters of a cell.
CoherentWindow window_about(LatticePoint place);
CoherentWindow window_about(LatticePoint place, const CoherentWindow& current);

/// The window's triangles relative to its origin. A cell's numbers follow from its place in the world (modulo 8), so a
/// triangle keeps its identity when the window moves.
std::vector<CoherentTriangle> base_triangles(const CoherentWindow& window);
/// Those of them whose cell another window does not have.
std::vector<CoherentTriangle> base_triangles(const CoherentWindow& window, const CoherentWindow& without);

/// What a pattern makes of a triangle, in the order of their numbers.
std::vector<CoherentTriangle> divided(const CoherentTriangle& triangle, int pattern);

/// Whether the edge between two places relative to the mesh's origin is to be split.
using EdgeTest = std::function<bool(glm::ivec2, glm::ivec2)>;
/// Refines until no edge is to be split or `most_levels` is reached.
std::vector<CoherentTriangle> refined(const std::vector<CoherentTriangle>& base, const EdgeTest& wants_split,
                                      int most_levels = coherent_most_levels);

}  // namespace trochoid
