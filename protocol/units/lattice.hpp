#pragma once
#include <compare>
#include <cstdint>

namespace trochoid {

/// Lattice units in a metre: positions are integers of 2^-10 m, so a phase is exact anywhere in the world.
inline constexpr int64_t lattice_per_metre = 1024;

/// Largest |x|, |z| in the world, in lattice units (2^35, 33,554 km). Beyond is an error, never a wrap.
inline constexpr int64_t world_bound = int64_t{1} << 35;

/// A horizontal position: x east, z south, both in lattice units.
struct LatticePoint {
    int64_t x = 0;
    int64_t z = 0;
    auto operator<=>(const LatticePoint&) const = default;
};

/// True where both coordinates lie inside the world bounds.
constexpr bool inside_world(LatticePoint p) {
    return p.x >= -world_bound && p.x <= world_bound && p.z >= -world_bound && p.z <= world_bound;
}

/// Metres to lattice units, rounded half away from zero. Exact for every |metres| < 2^42.
constexpr int64_t to_lattice(double metres) {
    const double scaled = metres * static_cast<double>(lattice_per_metre);
    return static_cast<int64_t>(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
}

/// Lattice units to metres (exact in double for the whole world).
constexpr double to_metres(int64_t units) {
    return static_cast<double>(units) / static_cast<double>(lattice_per_metre);
}

/// Closed axis-aligned rectangle in lattice units: min and max belong to it.
struct LatticeRect {
    LatticePoint min;
    LatticePoint max;
    bool operator==(const LatticeRect&) const = default;
};

constexpr bool contains(const LatticeRect& r, LatticePoint p) {
    return p.x >= r.min.x && p.x <= r.max.x && p.z >= r.min.z && p.z <= r.max.z;
}

constexpr bool overlap(const LatticeRect& a, const LatticeRect& b) {
    return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.z <= b.max.z && b.min.z <= a.max.z;
}

}  // namespace trochoid
