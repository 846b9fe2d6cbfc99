#include "protocol/model/simd/water_batch.hpp"

#include <algorithm>
#include <memory>

#include "protocol/model/ordered_sum.hpp"
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

/// The search for the rest points of places that have not been found yet.
struct alignas(64) Search {
    SpanOf<int32_t> x, z;            ///< rest point, from the place: at most 4 steps of 64 m
    SpanOf<int32_t> step_x, step_z;  ///< the last step that led there
    SpanOf<uint8_t> place;           ///< index of the place
};

/// Sums at the first n rest points.
template <int parts>
void sum_places(const Plan& plan, const LatticePoint* places, const Search& search, int n, Scratch& at) {
    at.padded = padded_count(n);
    for (size_t i = 0; i < static_cast<size_t>(n); ++i) {
        at.x[i] = places[search.place[i]].x + search.x[i];
        at.z[i] = places[search.place[i]].z + search.z[i];
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
    const uint32_t* x = at.x_low.data();
    const uint32_t* z = at.z_low.data();
    const auto phases = [x, z](size_t i) HWY_ATTR {
        return PlacePhases{hn::Load(du, x + i), hn::Load(du, z + i)};
    };
    sum_span<parts>(plan, n, at, [&](size_t) HWY_ATTR { return phases; });
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

HWY_INLINE void newton_step(const SpanSums& m, Search& search, size_t i) {
    const VecI ox = hn::Load(di, &search.x[i]);
    const VecI oz = hn::Load(di, &search.z[i]);
    const VecF pxx = sub(splat(1.0F), hn::Load(df, &m.mxx[i]));
    const VecF pxz = hn::Neg(hn::Load(df, &m.mxz[i]));
    const VecF pzx = hn::Neg(hn::Load(df, &m.mzx[i]));
    const VecF pzz = sub(splat(1.0F), hn::Load(df, &m.mzz[i]));
    const VecF fx = sub(mul(hn::ConvertTo(df, ox), splat(0x1p-10F)), hn::Load(df, &m.ax[i]));
    const VecF fz = sub(mul(hn::ConvertTo(df, oz), splat(0x1p-10F)), hn::Load(df, &m.az[i]));
    const VecF det = sub(mul(pxx, pzz), mul(pxz, pzx));
    const VecI dx = step_of(mul(splat(1024.0F), hn::Div(sub(mul(pzz, fx), mul(pxz, fz)), det)));
    const VecI dz = step_of(mul(splat(1024.0F), hn::Div(sub(mul(pxx, fz), mul(pzx, fx)), det)));
    hn::Store(dx, di, &search.step_x[i]);
    hn::Store(dz, di, &search.step_z[i]);
    hn::Store(hn::Sub(ox, dx), di, &search.x[i]);
    hn::Store(hn::Sub(oz, dz), di, &search.z[i]);
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

/// Whether the next step of most points will be shorter than half a unit, so that what is summed there is the answer: steps shrink
/// by their square, and after one of 1/4 m little is left in most seas. Being wrong costs time only.
HWY_INLINE bool nearly_there(const Search& search, size_t n) {
    constexpr int32_t near = 256;
    size_t close = 0;
    for (size_t i = 0; i < n; ++i) {
        const int32_t x = search.step_x[i];
        const int32_t z = search.step_z[i];
        close += x <= near && x >= -near && z <= near && z >= -near ? 1U : 0U;
    }
    return 2 * close > n;
}

/// Writes the answers of points that the last step has left in place, and moves the others together; returns how many those are.
HWY_INLINE int hand_out(const LatticePoint* places, Search& search, WaterPoint* out, int n,
                        const SpanSums& m) {
    size_t kept = 0;
    for (size_t i = 0; i < static_cast<size_t>(n); ++i) {
        const uint8_t place = search.place[i];
        if ((search.step_x[i] | search.step_z[i]) == 0) {
            const LatticePoint rest{places[place].x + search.x[i], places[place].z + search.z[i]};
            out[place] = {m.ay[i], m.bx[i], m.mxx[i], m.bz[i], m.vx[i], m.vy[i], m.vz[i], rest};
            continue;
        }
        search.x[kept] = search.x[i];
        search.z[kept] = search.z[i];
        search.step_x[kept] = search.step_x[i];
        search.step_z[kept] = search.step_z[i];
        search.place[kept++] = place;
    }
    return static_cast<int>(kept);
}

/// water_at for n places, 1 to span_points: four steps each. A step that leaves a point where it is ends its search: the sums there
/// stay what they are, and so every further step would be as short.
void water_span(const Plan& plan, const LatticePoint* places, WaterPoint* out, int n, Scratch& at) {
    constexpr int newton_steps = 4;
    Search search{};
    for (size_t i = 0; i < span_points; ++i) search.place[i] = static_cast<uint8_t>(i);
    for (int left = newton_steps; n != 0; --left) {
        const auto count = static_cast<size_t>(n);
        const bool whole = left == 0 || (left != newton_steps && nearly_there(search, count));
        if (whole)
            sum_places<sum_all>(plan, places, search, n, at);
        else
            sum_places<sum_newton>(plan, places, search, n, at);
        if (left == 0)
            search.step_x = search.step_z = {};
        else
            for (size_t i = 0; i < count; i += lanes) newton_step(at.sums, search, i);
        if (!whole) continue;
        for (size_t i = 0; i < count; i += lanes) finish_water(at.sums, i);
        n = hand_out(places, search, out, n, at.sums);
    }
}

/// SeaInstant::evaluate for n rest points, 1 to span_points.
void surface_span(const Plan& plan, const LatticePoint* rests, SurfaceSample* out, int n, Scratch& at) {
    Search found{};
    for (size_t i = 0; i < span_points; ++i) found.place[i] = static_cast<uint8_t>(i);
    sum_places<sum_all>(plan, rests, found, n, at);
    for (size_t i = 0; i < static_cast<size_t>(n); ++i) out[i] = finish(sums_at(at.sums, i));
}

}  // namespace trochoid::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trochoid {

namespace simd {
HWY_EXPORT(water_span);
HWY_EXPORT(surface_span);

namespace {

/// A rectangle around the points and `reach` beyond.
LatticeRect around(std::span<const LatticePoint> points, int64_t reach) {
    LatticeRect r{points[0], points[0]};
    for (const LatticePoint& p : points) {
        r.min = {std::min(r.min.x, p.x), std::min(r.min.z, p.z)};
        r.max = {std::max(r.max.x, p.x), std::max(r.max.z, p.z)};
    }
    return {{r.min.x - reach, r.min.z - reach}, {r.max.x + reach, r.max.z + reach}};
}

/// Calls span(plan, first, n, scratch) for all points, span_points at a time.
template <class Span>
void by_spans(const SeaInstant& sea, std::span<const LatticePoint> points, int64_t reach, Workers& workers,
              Span span) {
    if (points.empty()) return;
    const Plan plan = plan_of(sea, {}, 1, 1, around(points, reach));
    constexpr size_t at_once = span_points;
    std::vector<std::unique_ptr<Scratch>> scratch(workers.threads());
    workers.run((points.size() + at_once - 1) / at_once, [&](size_t part, unsigned thread) {
        auto& mine = scratch[thread];
        if (!mine) mine = std::make_unique<Scratch>(plan);
        const size_t first = part * at_once;
        span(plan, first, static_cast<int>(std::min(at_once, points.size() - first)), *mine);
    });
}

}  // namespace
}  // namespace simd

void water_at_batch(const SeaInstant& sea, std::span<const LatticePoint> places, std::span<WaterPoint> out,
                    Workers& workers) {
    TROCHOID_ASSERT(out.size() == places.size(), "{} answers for {} places", out.size(), places.size());
    // Each of the four steps is at most 64 m along x and z.
    constexpr int64_t reach = 4 * 65536;
    simd::by_spans(sea, places, reach, workers,
                   [&](const simd::Plan& plan, size_t first, int n, simd::Scratch& at) {
                       using namespace simd;
                       HWY_DYNAMIC_DISPATCH(water_span)(plan, &places[first], &out[first], n, at);
                   });
}

void evaluate_batch(const SeaInstant& sea, std::span<const LatticePoint> rests, std::span<SurfaceSample> out,
                    Workers& workers) {
    TROCHOID_ASSERT(out.size() == rests.size(), "{} samples for {} points", out.size(), rests.size());
    simd::by_spans(sea, rests, 0, workers,
                   [&](const simd::Plan& plan, size_t first, int n, simd::Scratch& at) {
                       using namespace simd;
                       HWY_DYNAMIC_DISPATCH(surface_span)(plan, &rests[first], &out[first], n, at);
                   });
}

}  // namespace trochoid
#endif
