#include "protocol/model/simd/coarse_grid.hpp"

#include <algorithm>
#include <array>

#include "protocol/model/simd/highway.hpp"
#include "protocol/model/simd/plan.hpp"
#include "protocol/units/assert.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "protocol/model/simd/coarse_grid.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace trochoid::simd::HWY_NAMESPACE {

/// row[i] += bilinear of two rows of the coarse grid, `down` between them; cells of `factor` points.
template <int factor>
void add_row(const float* north, const float* south, float down, float* row, int32_t n) {
    for (int32_t i = 0; i < n; i += factor, ++north, ++south) {
        const float west = north[0] + down * (south[0] - north[0]);
        const float east = north[1] + down * (south[1] - north[1]);
        const float step = (east - west) * (1.0F / factor);
        if (n - i >= factor)
            for (int32_t k = 0; k < factor; ++k) row[i + k] += west + static_cast<float>(k) * step;
        else
            for (int32_t k = 0; k < n - i; ++k) row[i + k] += west + static_cast<float>(k) * step;
    }
}

void AddRow(int factor, const float* north, const float* south, float down, float* row, int32_t n) {
    switch (factor) {
        case 2: return add_row<2>(north, south, down, row, n);
        case 4: return add_row<4>(north, south, down, row, n);
        case 8: return add_row<8>(north, south, down, row, n);
        default: return add_row<16>(north, south, down, row, n);
    }
}

/// The normal from the derivatives of a row.
void NormalRow(const SurfacePlanes& p, size_t first, size_t n) {
    for (size_t i = first; i < first + n; ++i) {
        const float pxx = p.pxx[i], pxz = p.pxz[i], pzx = p.pzx[i], pzz = p.pzz[i];
        const float yx = p.yx[i], yz = p.yz[i];
        if (p.nx != nullptr) p.nx[i] = yz * pzx - pzz * yx;
        if (p.ny != nullptr) p.ny[i] = pzz * pxx - pxz * pzx;
        if (p.nz != nullptr) p.nz[i] = pxz * yx - yz * pxx;
    }
}

}  // namespace trochoid::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trochoid {

namespace simd {
HWY_EXPORT(AddRow);
HWY_EXPORT(NormalRow);
}  // namespace simd

namespace {

/// The planes whose values are sums over trains; pxx and pzz start from 1.
constexpr std::array summed_planes{&SurfacePlanes::ax,  &SurfacePlanes::ay,  &SurfacePlanes::az,
                                   &SurfacePlanes::pxx, &SurfacePlanes::pxz, &SurfacePlanes::pzx,
                                   &SurfacePlanes::pzz, &SurfacePlanes::yx,  &SurfacePlanes::yz,
                                   &SurfacePlanes::vx,  &SurfacePlanes::vy,  &SurfacePlanes::vz};

bool is_long(const WaveTrain& train, const TrainConstants& c, double coarse_step_m, double ratio) {
    return train.field.value == 0 && static_cast<double>(c.wavelength) >= ratio * coarse_step_m;
}

/// Adds what interpolating this train may cost.
void add_error(CoarseBound& bound, const TrainConstants& c, double gain, double step_x, double step_z) {
    const double kx = static_cast<double>(c.kx);
    const double kz = static_cast<double>(c.kz);
    const double bend = gain * (kx * kx * step_x * step_x + kz * kz * step_z * step_z) / 8.0 + 1e-5;
    const double a = static_cast<double>(c.a);
    bound.height += a * bend;
    bound.horizontal +=
        std::max(std::abs(static_cast<double>(c.hx)), std::abs(static_cast<double>(c.hz))) * bend;
    bound.slope += a * static_cast<double>(c.k) * bend;
    ++bound.trains;
}

struct Split {
    std::vector<std::shared_ptr<const PreparedBox>> fine;
    std::vector<std::shared_ptr<const PreparedBox>> coarse;
    CoarseBound bound;
};

Split split(const SeaInstant& sea, const simd::Plan& plan, const LatticeRect& rect, double step_x,
            double step_z, double ratio) {
    Split out;
    if (!sea.layers().has(Layer::trains)) return out;
    for (const simd::PlannedBox& planned : plan.boxes) {
        const PreparedBox& box = *planned.live->box;
        const bool even = !planned.uneven && !planned.round && cover_of(planned, rect) == simd::Cover::full;
        WaveTrainBox short_waves = box.record;
        WaveTrainBox long_waves = box.record;
        short_waves.trains.clear();
        long_waves.trains.clear();
        long_waves.noise = {};
        long_waves.wake = {};
        const double gain = static_cast<double>(planned.live->instant.time_gain) * 0x1p-24;
        for (size_t i = 0; i < box.record.trains.size(); ++i) {
            const bool coarse =
                even && is_long(box.record.trains[i], box.constants[i], std::max(step_x, step_z), ratio);
            (coarse ? long_waves : short_waves).trains.push_back(box.record.trains[i]);
            if (coarse) add_error(out.bound, box.constants[i], gain, step_x, step_z);
        }
        if (long_waves.trains.empty()) {
            out.fine.push_back(planned.live->box);
            continue;
        }
        out.coarse.push_back(prepare(std::move(long_waves), {}));
        // With all that the fields lie over: prepare joins them anew.
        std::vector<std::shared_ptr<const LandField>> fields;
        for (const auto& top : box.fields)
            for (auto field = top; field; field = field->base()) fields.push_back(field);
        out.fine.push_back(prepare(std::move(short_waves), fields));
    }
    return out;
}

}  // namespace

CoarseBound evaluate_coarse_grid(const SeaInstant& sea, const LatticeGrid& grid, const SurfacePlanes& planes,
                                 const CoarseOptions& options, Workers& workers) {
    const int factor = options.factor;
    TROCHOID_ASSERT((factor == 2 || factor == 4 || factor == 8 || factor == 16) && options.ratio > 0.0,
                    "coarse grid: factor {}, ratio {}", factor, options.ratio);
    LatticeGrid coarse = grid;
    coarse.step_x = grid.step_x * factor;
    coarse.step_z = grid.step_z * factor;
    coarse.nx = (grid.nx + factor - 1) / factor + 1;
    coarse.nz = (grid.nz + factor - 1) / factor + 1;
    const bool fits = grid.size() != 0 && inside_world(coarse.at(coarse.nx - 1, coarse.nz - 1)) &&
                      coarse.step_x <= longest_side && coarse.step_z <= longest_side;
    Split parts;
    if (fits) {
        const LatticeRect rect{coarse.origin, coarse.at(coarse.nx - 1, coarse.nz - 1)};
        const simd::Plan plan = simd::plan_of(sea, grid.origin, grid.step_x, grid.step_z, rect);
        parts = split(sea, plan, rect, to_metres(coarse.step_x), to_metres(coarse.step_z), options.ratio);
    }
    if (parts.bound.trains == 0) {
        evaluate_grid(sea, grid, planes, workers);
        return {};
    }
    // Planes that the normal needs although nobody else asked for them.
    SurfacePlanes wanted = planes;
    std::vector<std::vector<float>> own;
    const auto need = [&](float*& plane, size_t size) {
        if (plane != nullptr) return;
        own.emplace_back(size);
        plane = own.back().data();
    };
    const bool normal = planes.nx != nullptr || planes.ny != nullptr || planes.nz != nullptr;
    own.reserve(2 * summed_planes.size());
    if (normal)
        for (const auto plane : {&SurfacePlanes::pxx, &SurfacePlanes::pxz, &SurfacePlanes::pzx,
                                 &SurfacePlanes::pzz, &SurfacePlanes::yx, &SurfacePlanes::yz})
            need(wanted.*plane, grid.size());
    SurfacePlanes sums = wanted;
    sums.nx = sums.ny = sums.nz = nullptr;
    SurfacePlanes sparse;
    for (const auto plane : summed_planes)
        if (wanted.*plane != nullptr) need(sparse.*plane, coarse.size());
    evaluate_grid(SeaInstant(Sea(std::move(parts.fine)), sea.time(), sea.layers()), grid, sums, workers);
    evaluate_grid(SeaInstant(Sea(std::move(parts.coarse)), sea.time(), sea.layers()), coarse, sparse,
                  workers);
    for (const auto plane : {&SurfacePlanes::pxx, &SurfacePlanes::pzz})
        if (float* values = sparse.*plane)
            for (size_t i = 0; i < coarse.size(); ++i) values[i] -= 1.0F;

    workers.run(static_cast<size_t>(grid.nz), [&](size_t j, unsigned) {
        const size_t row = j / static_cast<size_t>(factor) * static_cast<size_t>(coarse.nx);
        const auto below = static_cast<size_t>(coarse.nx);
        const float down = static_cast<float>(j % static_cast<size_t>(factor)) / static_cast<float>(factor);
        const size_t first = j * static_cast<size_t>(grid.nx);
        using namespace simd;
        for (const auto plane : summed_planes)
            if (wanted.*plane != nullptr) HWY_DYNAMIC_DISPATCH(AddRow)
        (factor, sparse.*plane + row, sparse.*plane + row + below, down, wanted.*plane + first, grid.nx);
        if (normal) HWY_DYNAMIC_DISPATCH(NormalRow)(wanted, first, static_cast<size_t>(grid.nx));
    });
    return parts.bound;
}

}  // namespace trochoid
#endif
