#include "protocol/model/simd/sea_grid.hpp"

#include <algorithm>
#include <cstring>
#include <memory>

#include "protocol/model/simd/highway.hpp"
#include "protocol/model/simd/scratch.hpp"
#include "protocol/units/assert.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "protocol/model/simd/sea_grid.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "protocol/model/simd/span_kernel-inl.hpp"

#ifndef TROCHOID_SIMD_GRID_TYPES
#define TROCHOID_SIMD_GRID_TYPES
namespace trochoid::simd {

/// One call's work: what all tiles share.
struct GridWork {
    const Plan& plan;
    const LatticeGrid& grid;
    const SurfacePlanes& planes;
    bool matrix = false;  ///< derivatives or normal wanted
    bool speed = false;
};

}  // namespace trochoid::simd
#endif

HWY_BEFORE_NAMESPACE();
namespace trochoid::simd::HWY_NAMESPACE {

/// Where a vector of results goes: straight to its plane, or, where the row ends within it, by way of a vector in memory.
struct Whole {
    HWY_INLINE void operator()(VecF v, float* to) const { hn::StoreU(v, df, to); }
};
struct Part {
    size_t points;
    HWY_INLINE void operator()(VecF v, float* to) const {
        HWY_ALIGN float values[lanes];
        hn::Store(v, df, values);
        std::memcpy(to, values, points * sizeof(float));
    }
};

/// SeaInstant's `finish` for the vector of the sums at i, into the planes at `to`.
template <int parts, class Put>
HWY_INLINE void finish_vector(const SurfacePlanes& out, const SpanSums& m, size_t i, size_t to, Put store) {
    const auto put = [&](VecF v, float* plane) HWY_ATTR {
        if (plane != nullptr) store(v, plane + to);
    };
    put(hn::Load(df, &m.ax[i]), out.ax);
    put(hn::Load(df, &m.ay[i]), out.ay);
    put(hn::Load(df, &m.az[i]), out.az);
    if constexpr ((parts & sum_matrix) != 0) {
        const VecF one = splat(1.0F);
        const VecF pxx = sub(one, hn::Load(df, &m.mxx[i]));
        const VecF pxz = hn::Neg(hn::Load(df, &m.mxz[i]));
        const VecF pzx = hn::Neg(hn::Load(df, &m.mzx[i]));
        const VecF pzz = sub(one, hn::Load(df, &m.mzz[i]));
        const VecF yx = hn::Neg(hn::Load(df, &m.bx[i]));
        const VecF yz = hn::Neg(hn::Load(df, &m.bz[i]));
        put(pxx, out.pxx);
        put(pxz, out.pxz);
        put(pzx, out.pzx);
        put(pzz, out.pzz);
        put(yx, out.yx);
        put(yz, out.yz);
        put(sub(mul(yz, pzx), mul(pzz, yx)), out.nx);
        put(sub(mul(pzz, pxx), mul(pxz, pzx)), out.ny);
        put(sub(mul(pxz, yx), mul(yz, pxx)), out.nz);
    }
    if constexpr ((parts & sum_speed) != 0) {
        put(hn::Load(df, &m.vx[i]), out.vx);
        put(hn::Load(df, &m.vy[i]), out.vy);
        put(hn::Load(df, &m.vz[i]), out.vz);
    }
}

/// A row of sums into the planes from point `first` on. Has its own copy of the planes, which no store can change.
template <int parts>
HWY_NOINLINE void finish_row(const SurfacePlanes out, const SpanSums& m, size_t first, size_t n) {
    size_t i = 0;
    for (; i + lanes <= n; i += lanes) finish_vector<parts>(out, m, i, first + i, Whole{});
    if (i != n) finish_vector<parts>(out, m, i, first + i, Part{n - i});
}

/// Readies the phases of every train of at.stretches for the part whose first point is (i0, j0) and whose rows are n points long.
inline void start_phases(const Plan& plan, int32_t i0, int32_t j0, int n, Scratch& at) {
    const VecU lane = hn::Iota(du, 0);
    const auto width = static_cast<uint32_t>(lanes);
    const uint32_t vectors = (static_cast<uint32_t>(n) + width - 1) / width;
    for (const Stretch& stretch : at.stretches)
        for (int32_t t = stretch.first_row; t < stretch.first_row + stretch.rows; ++t) {
            const TrainRow& row = plan.rows[static_cast<size_t>(t)];
            PhaseVector& phases = at.phases[static_cast<size_t>(t)];
            const uint32_t start =
                row.phase + static_cast<uint32_t>(j0) * row.kz + static_cast<uint32_t>(i0) * row.kx;
            hn::Store(hn::Add(hn::Set(du, start), hn::Mul(lane, hn::Set(du, row.kx))), du,
                      phases.turns.data());
            const uint32_t step = row.kx * width;
            phases.moves = {step, row.kz - (vectors - 1) * step};
        }
}

template <int parts>
void sum_row(const GridWork& work, int32_t i0, int32_t j, int n, Scratch& at) {
    const auto last = static_cast<size_t>(n - 1) / lanes * lanes;
    sum_span<parts>(work.plan, n, at, [&at, last](size_t first_row) HWY_ATTR {
        PhaseVector* phases = at.phases.data() + first_row;
        return [phases, last](size_t i) HWY_ATTR { return RowPhases{phases, i == last ? 1U : 0U}; };
    });
    finish_row<parts>(work.planes, at.sums,
                      static_cast<size_t>(j) * static_cast<size_t>(work.grid.nx) + static_cast<size_t>(i0),
                      static_cast<size_t>(n));
}

/// A part of a tile, n points wide, that at.stretches belong to.
void sum_part(const GridWork& work, int32_t i0, int32_t j0, int n, int32_t end, Scratch& at) {
    const LatticeGrid& grid = work.grid;
    at.padded = padded_count(n);
    // Trains on open water need no places, only phases.
    const bool placed = std::any_of(at.stretches.begin(), at.stretches.end(),
                                    [](const Stretch& s) { return s.box != nullptr; });
    for (size_t i = 0; placed && i < at.padded; ++i) {
        at.x[i] = grid.at(i0 + std::min<int32_t>(static_cast<int32_t>(i), n - 1), j0).x;
        at.x_low[i] = static_cast<uint32_t>(static_cast<uint64_t>(at.x[i]));
    }
    start_phases(work.plan, i0, j0, n, at);
    for (int32_t j = j0; j < end; ++j) {
        if (placed) {
            const int64_t z = grid.at(i0, j).z;
            for (size_t i = 0; i < at.padded; ++i) at.z[i] = z;
            for (size_t i = 0; i < at.padded; ++i)
                at.z_low[i] = static_cast<uint32_t>(static_cast<uint64_t>(z));
        }
        if (work.speed)
            sum_row<sum_all>(work, i0, j, n, at);
        else if (work.matrix)
            sum_row<sum_normal>(work, i0, j, n, at);
        else
            sum_row<sum_displacement>(work, i0, j, n, at);
    }
}

void grid_tile(const GridWork& work, int32_t i0, int32_t j0, Scratch& at) {
    constexpr int32_t narrow = 16;
    const LatticeGrid& grid = work.grid;
    const int32_t n = std::min<int32_t>(span_points, grid.nx - i0);
    const int32_t end = std::min<int32_t>(j0 + tile_rows, grid.nz);
    const auto look = [&](int32_t i, int32_t count) {
        stretches_of(work.plan, {grid.at(i, j0), grid.at(i + count - 1, end - 1)}, at.stretches);
    };
    look(i0, n);
    if (n <= narrow || !varies(at.stretches)) {
        sum_part(work, i0, j0, n, end, at);
        return;
    }
    // A box's edge is in the tile: narrower parts keep what varies small.
    for (int32_t i = i0; i < i0 + n; i += narrow) {
        const int32_t count = std::min(narrow, i0 + n - i);
        look(i, count);
        sum_part(work, i, j0, count, end, at);
    }
}

}  // namespace trochoid::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trochoid {

namespace simd {
HWY_EXPORT(grid_tile);
}  // namespace simd

namespace {

void check(const LatticeGrid& grid) {
    TROCHOID_ASSERT(grid.nx >= 0 && grid.nz >= 0 && grid.step_x >= 1 && grid.step_z >= 1 &&
                        grid.step_x <= longest_side && grid.step_z <= longest_side,
                    "a grid of {} x {} points, steps {} and {}", grid.nx, grid.nz, grid.step_x, grid.step_z);
    if (grid.size() != 0)
        TROCHOID_ASSERT(inside_world(grid.origin) && inside_world(grid.at(grid.nx - 1, grid.nz - 1)),
                        "a grid reaches out of the world");
}

}  // namespace

void evaluate_grid(const SeaInstant& sea, const LatticeGrid& grid, const SurfacePlanes& planes,
                   Workers& workers) {
    check(grid);
    if (grid.size() == 0) return;
    const simd::Plan plan = simd::plan_of(sea, grid.origin, grid.step_x, grid.step_z,
                                          {grid.origin, grid.at(grid.nx - 1, grid.nz - 1)});
    simd::GridWork work{plan, grid, planes};
    for (const float* plane : {planes.pxx, planes.pxz, planes.pzx, planes.pzz, planes.yx, planes.yz,
                               planes.nx, planes.ny, planes.nz})
        work.matrix |= plane != nullptr;
    for (const float* plane : {planes.vx, planes.vy, planes.vz}) work.speed |= plane != nullptr;
    const auto columns = static_cast<size_t>((grid.nx + simd::span_points - 1) / simd::span_points);
    const auto rows = static_cast<size_t>((grid.nz + simd::tile_rows - 1) / simd::tile_rows);
    std::vector<std::unique_ptr<simd::Scratch>> scratch(workers.threads());
    workers.run(rows, [&](size_t row, unsigned thread) {
        auto& mine = scratch[thread];
        if (!mine) mine = std::make_unique<simd::Scratch>(plan);
        for (size_t column = 0; column < columns; ++column) {
            using namespace simd;
            HWY_DYNAMIC_DISPATCH(grid_tile)
            (work, static_cast<int32_t>(column) * span_points, static_cast<int32_t>(row) * tile_rows, *mine);
        }
    });
}

void evaluate_grid(const SeaInstant& sea, const LatticeGrid& grid, std::span<SurfaceSample> out,
                   Workers& workers) {
    TROCHOID_ASSERT(out.size() == grid.size(), "{} samples for {} points", out.size(), grid.size());
    constexpr size_t values = 15;
    // Strips of rows keep the planes in the cache.
    const int32_t strip = 4 * simd::tile_rows * static_cast<int32_t>(workers.threads());
    std::vector<float> planes(values * static_cast<size_t>(grid.nx) *
                              static_cast<size_t>(std::min(strip, grid.nz)));
    for (int32_t j = 0; j < grid.nz; j += strip) {
        LatticeGrid part = grid;
        part.origin = grid.at(0, j);
        part.nz = std::min(strip, grid.nz - j);
        const size_t n = part.size();
        const auto plane = [&](size_t i) { return planes.data() + i * n; };
        evaluate_grid(
            sea, part,
            SurfacePlanes{plane(0), plane(1), plane(2), plane(3), plane(4), plane(5), plane(6), plane(7),
                          plane(8), plane(9), plane(10), plane(11), plane(12), plane(13), plane(14)},
            workers);
        SurfaceSample* sample = out.data() + static_cast<size_t>(j) * static_cast<size_t>(grid.nx);
        for (size_t i = 0; i < n; ++i, ++sample)
            *sample = {plane(0)[i],  plane(1)[i],  plane(2)[i],  plane(3)[i],  plane(4)[i],
                       plane(5)[i],  plane(6)[i],  plane(7)[i],  plane(8)[i],  plane(9)[i],
                       plane(10)[i], plane(11)[i], plane(12)[i], plane(13)[i], plane(14)[i]};
    }
}

}  // namespace trochoid
#endif
