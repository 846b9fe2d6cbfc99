#include "protocol/model/simd/water_batch.hpp"

#include <algorithm>
#include <memory>

#include "protocol/model/simd/highway.hpp"
#include "protocol/model/simd/scratch.hpp"
#include "protocol/units/assert.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "protocol/model/simd/water_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "protocol/model/simd/span_kernel-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace trochoid::simd::HWY_NAMESPACE {

/// Where each place's rest point is, relative to the place: at most 4 steps of 64 m.
struct alignas(64) Offsets {
    SpanOf<int32_t> x, z;
};

template <int parts>
void sum_places(const Plan& plan, const LatticePoint* places, const Offsets& offsets, int n, Scratch& at) {
    at.padded = padded_count(n);
    for (size_t i = 0; i < static_cast<size_t>(n); ++i) {
        at.x[i] = places[i].x + offsets.x[i];
        at.z[i] = places[i].z + offsets.z[i];
    }
    for (size_t i = static_cast<size_t>(n); i < at.padded; ++i) {
        at.x[i] = at.x[static_cast<size_t>(n) - 1];
        at.z[i] = at.z[static_cast<size_t>(n) - 1];
    }
    LatticeRect rect{{at.x[0], at.z[0]}, {at.x[0], at.z[0]}};
    for (size_t i = 0; i < at.padded; ++i) {
        at.x_low[i] = static_cast<uint32_t>(static_cast<uint64_t>(at.x[i]));
        rect.min.x = std::min(rect.min.x, at.x[i]);
        rect.max.x = std::max(rect.max.x, at.x[i]);
    }
    for (size_t i = 0; i < at.padded; ++i) {
        at.z_low[i] = static_cast<uint32_t>(static_cast<uint64_t>(at.z[i]));
        rect.min.z = std::min(rect.min.z, at.z[i]);
        rect.max.z = std::max(rect.max.z, at.z[i]);
    }
    stretches_of(plan, rect, at.stretches);
    sum_span<parts>(
        plan, n, at, [](const Stretch&) HWY_ATTR {},
        [&](size_t i) HWY_ATTR {
            return PlacePhases{hn::Load(du, &at.x_low[i]), hn::Load(du, &at.z_low[i])};
        });
}

/// clamp_step and round_half_even of point_query.cpp. The sum with 1.5 * 2^23 rounds in the adder itself.
HWY_INLINE VecI step_of(VecF v) {
    const VecF most = splat(65536.0F);
    const VecF least = splat(-65536.0F);
    VecF held = hn::IfThenElseZero(hn::Eq(v, v), v);
    held = hn::IfThenElse(hn::Ge(v, most), most, held);
    held = hn::IfThenElse(hn::Le(v, least), least, held);
    const VecI shifted = hn::BitCast(di, add(held, splat(0x1.8p+23F)));
    return hn::Sub(shifted, hn::Set(di, 0x4b400000));
}

HWY_INLINE void newton_step(const SpanSums& m, Offsets& offsets, size_t i) {
    const VecI ox = hn::Load(di, &offsets.x[i]);
    const VecI oz = hn::Load(di, &offsets.z[i]);
    const VecF pxx = sub(splat(1.0F), hn::Load(df, &m.mxx[i]));
    const VecF pxz = hn::Neg(hn::Load(df, &m.mxz[i]));
    const VecF pzx = hn::Neg(hn::Load(df, &m.mzx[i]));
    const VecF pzz = sub(splat(1.0F), hn::Load(df, &m.mzz[i]));
    const VecF fx = sub(mul(hn::ConvertTo(df, ox), splat(0x1p-10F)), hn::Load(df, &m.ax[i]));
    const VecF fz = sub(mul(hn::ConvertTo(df, oz), splat(0x1p-10F)), hn::Load(df, &m.az[i]));
    const VecF det = sub(mul(pxx, pzz), mul(pxz, pzx));
    const VecF dx = hn::Div(sub(mul(pzz, fx), mul(pxz, fz)), det);
    const VecF dz = hn::Div(sub(mul(pxx, fz), mul(pzx, fx)), det);
    hn::Store(hn::Sub(ox, step_of(mul(splat(1024.0F), dx))), di, &offsets.x[i]);
    hn::Store(hn::Sub(oz, step_of(mul(splat(1024.0F), dz))), di, &offsets.z[i]);
}

/// Unit normals, in place of the slopes' accumulators: bx, mxx, bz.
HWY_INLINE void finish_water(SpanSums& m, size_t i) {
    const VecF pxx = sub(splat(1.0F), hn::Load(df, &m.mxx[i]));
    const VecF pxz = hn::Neg(hn::Load(df, &m.mxz[i]));
    const VecF pzx = hn::Neg(hn::Load(df, &m.mzx[i]));
    const VecF pzz = sub(splat(1.0F), hn::Load(df, &m.mzz[i]));
    const VecF yx = hn::Neg(hn::Load(df, &m.bx[i]));
    const VecF yz = hn::Neg(hn::Load(df, &m.bz[i]));
    const VecF nx = sub(mul(yz, pzx), mul(pzz, yx));
    const VecF ny = sub(mul(pzz, pxx), mul(pxz, pzx));
    const VecF nz = sub(mul(pxz, yx), mul(yz, pxx));
    const VecF length = hn::Sqrt(add(add(mul(nx, nx), mul(ny, ny)), mul(nz, nz)));
    hn::Store(hn::Div(nx, length), df, &m.bx[i]);
    hn::Store(hn::Div(ny, length), df, &m.mxx[i]);
    hn::Store(hn::Div(nz, length), df, &m.bz[i]);
}

/// water_at for n places, 1 to span_points.
void WaterSpan(const Plan& plan, const LatticePoint* places, WaterPoint* out, int n, Scratch& at) {
    constexpr int newton_steps = 4;
    Offsets offsets{};
    for (int step = 0; step < newton_steps; ++step) {
        sum_places<sum_newton>(plan, places, offsets, n, at);
        for (size_t i = 0; i < static_cast<size_t>(n); i += lanes) newton_step(at.sums, offsets, i);
    }
    sum_places<sum_all>(plan, places, offsets, n, at);
    for (size_t i = 0; i < static_cast<size_t>(n); i += lanes) finish_water(at.sums, i);
    const SpanSums& m = at.sums;
    for (size_t i = 0; i < static_cast<size_t>(n); ++i)
        out[i] = {m.ay[i], m.bx[i], m.mxx[i], m.bz[i],
                  m.vx[i], m.vy[i], m.vz[i],  {places[i].x + offsets.x[i], places[i].z + offsets.z[i]}};
}

}  // namespace trochoid::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trochoid {

namespace simd {
HWY_EXPORT(WaterSpan);

namespace {

/// Where the rest points of places can lie: each of the four steps is at most 64 m along x and z.
LatticeRect bounds_of(std::span<const LatticePoint> places) {
    constexpr int64_t reach = 4 * 65536;
    LatticeRect r{places[0], places[0]};
    for (const LatticePoint& p : places) {
        r.min = {std::min(r.min.x, p.x), std::min(r.min.z, p.z)};
        r.max = {std::max(r.max.x, p.x), std::max(r.max.z, p.z)};
    }
    return {{r.min.x - reach, r.min.z - reach}, {r.max.x + reach, r.max.z + reach}};
}

}  // namespace
}  // namespace simd

void water_at_batch(const SeaInstant& sea, std::span<const LatticePoint> places, std::span<WaterPoint> out,
                    Workers& workers) {
    TROCHOID_ASSERT(out.size() == places.size(), "{} answers for {} places", out.size(), places.size());
    if (places.empty()) return;
    const simd::Plan plan = simd::plan_of(sea, {}, 1, 1, simd::bounds_of(places));
    constexpr size_t at_once = simd::span_points;
    std::vector<std::unique_ptr<simd::Scratch>> scratch(workers.threads());
    workers.run((places.size() + at_once - 1) / at_once, [&](size_t part, unsigned thread) {
        auto& mine = scratch[thread];
        if (!mine) mine = std::make_unique<simd::Scratch>(plan);
        const size_t first = part * at_once;
        const size_t n = std::min(at_once, places.size() - first);
        using namespace simd;
        HWY_DYNAMIC_DISPATCH(WaterSpan)
        (plan, places.data() + first, out.data() + first, static_cast<int>(n), *mine);
    });
}

}  // namespace trochoid
#endif
