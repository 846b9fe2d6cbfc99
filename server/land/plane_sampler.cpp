#include "server/land/plane_sampler.hpp"

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/wide_rows.hpp"

namespace trochoid {

namespace {

inline float value_at(const float* north, const float* south, float fx, float fz) {
    const float west = north[0] + (south[0] - north[0]) * fz;
    const float east = north[1] + (south[1] - north[1]) * fz;
    return west + (east - west) * fx;
}

TROCHOID_WIDE_ROWS void place_points(const ObliqueRow& row, size_t from, size_t to, int32_t pitch,
                                     int32_t* __restrict index, float* __restrict fx, float* __restrict fz) {
    // Inside the plane: nothing is negative.
    auto x = static_cast<uint64_t>(row.x) + from * static_cast<uint64_t>(row.dx);
    auto z = static_cast<uint64_t>(row.z) + from * static_cast<uint64_t>(row.dz);
    const auto dx = static_cast<uint64_t>(row.dx);
    const auto dz = static_cast<uint64_t>(row.dz);
    for (size_t j = from; j < to; ++j) {
        index[j] = static_cast<int32_t>(z >> 32) * pitch + static_cast<int32_t>(x >> 32);
        fx[j] = static_cast<float>(static_cast<int32_t>(static_cast<uint32_t>(x) >> 8)) * 0x1p-24F;
        fz[j] = static_cast<float>(static_cast<int32_t>(static_cast<uint32_t>(z) >> 8)) * 0x1p-24F;
        x += dx;
        z += dz;
    }
}

}  // namespace

void PlaneSampler::place(const ObliqueRow& row, IndexRange inside, size_t pitch) {
    pitch_ = pitch;
    const auto to = static_cast<size_t>(inside.to);
    if (index_.size() < to) {
        index_.resize(to);
        fx_.resize(to);
        fz_.resize(to);
    }
    place_points(row, static_cast<size_t>(inside.from), to, static_cast<int32_t>(pitch), index_.data(),
                 fx_.data(), fz_.data());
}

void PlaneSampler::sample(const float* plane, IndexRange range, float* out) const {
    const int32_t* const index = index_.data();
    const float* const fx = fx_.data();
    const float* const fz = fz_.data();
    const auto to = static_cast<size_t>(range.to);
    auto j = static_cast<size_t>(range.from);
    for (; j + 4 <= to; j += 4) {
        const float* const a = plane + index[j];
        const float* const b = plane + index[j + 1];
        const float* const c = plane + index[j + 2];
        const float* const d = plane + index[j + 3];
        prefetch(d + 2 * pitch_);
        FourFloats across;
        FourFloats down;
        std::memcpy(&across, fx + j, sizeof across);
        std::memcpy(&down, fz + j, sizeof down);
        const FourFloats north_ab = two_pairs(a, b);
        const FourFloats north_cd = two_pairs(c, d);
        const FourFloats south_ab = two_pairs(a + pitch_, b + pitch_);
        const FourFloats south_cd = two_pairs(c + pitch_, d + pitch_);
        const FourFloats ab = north_ab + (south_ab - north_ab) * shuffled<0, 0, 1, 1>(down, down);
        const FourFloats cd = north_cd + (south_cd - north_cd) * shuffled<2, 2, 3, 3>(down, down);
        const FourFloats west = shuffled<0, 2, 4, 6>(ab, cd);
        const FourFloats east = shuffled<1, 3, 5, 7>(ab, cd);
        const FourFloats value = west + (east - west) * across;
        std::memcpy(out + j, &value, sizeof value);
    }
    for (; j < to; ++j) out[j] = value_at(plane + index[j], plane + index[j] + pitch_, fx[j], fz[j]);
}

void PlaneSampler::sample_solid(const float* plane, IndexRange range, float* out) const {
    sample(plane, range, out);
    for (auto j = static_cast<size_t>(range.from); j < static_cast<size_t>(range.to); ++j) {
        const float* const near = plane + index_[j] + (fz_[j] >= 0.5F ? pitch_ : 0);
        out[j] = near[fx_[j] >= 0.5F ? 1 : 0] == 0.0F ? 0.0F : out[j];
    }
}

}  // namespace trochoid
