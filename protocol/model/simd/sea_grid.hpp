#pragma once
#include <cstdint>
#include <span>

#include "protocol/model/sea.hpp"
#include "protocol/model/simd/workers.hpp"

namespace trochoid {

/// Rest points of a regular grid: (origin.x + i * step_x, origin.z + j * step_z) for i < nx, j < nz; row-major, x runs fastest.
struct LatticeGrid {
    LatticePoint origin;
    int64_t step_x = lattice_per_metre;  ///< lattice units, 1 to 2^30
    int64_t step_z = lattice_per_metre;
    int32_t nx = 0;
    int32_t nz = 0;
    size_t size() const { return static_cast<size_t>(nx) * static_cast<size_t>(nz); }
    LatticePoint at(int32_t i, int32_t j) const { return {origin.x + i * step_x, origin.z + j * step_z}; }
};

/// Where a grid's values go: one plane of nx * nz floats for each value of SurfaceSample that is wanted, null for the others.
/// What is not wanted is not computed: only ax, ay, az cost least; the derivatives and the normal more; velocities most. Planes that begin
/// at multiples of 64 bytes are written fastest.
struct SurfacePlanes {
    float* ax = nullptr;
    float* ay = nullptr;
    float* az = nullptr;
    float* pxx = nullptr;
    float* pxz = nullptr;
    float* pzx = nullptr;
    float* pzz = nullptr;
    float* yx = nullptr;
    float* yz = nullptr;
    float* nx = nullptr;
    float* ny = nullptr;
    float* nz = nullptr;
    float* vx = nullptr;
    float* vy = nullptr;
    float* vz = nullptr;
};

/// The surface at every point of a grid, to the bit SeaInstant::evaluate at that point, whatever machine or number of
/// threads. All points have to lie inside the world (our bug otherwise).
void evaluate_grid(const SeaInstant& sea, const LatticeGrid& grid, const SurfacePlanes& planes,
                   Workers& workers);

/// The same with every value, row-major; out.size() == grid.size().
void evaluate_grid(const SeaInstant& sea, const LatticeGrid& grid, std::span<SurfaceSample> out,
                   Workers& workers);

}  // namespace trochoid
