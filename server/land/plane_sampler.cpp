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

TROCHOID_WIDE_ROWS void sample_points(const float* __restrict plane, size_t pitch,
                                      const int32_t* __restrict index, const float* __restrict fx,
                                      const float* __restrict fz, size_t count, float* __restrict out) {
    const float* const plane_south = plane + pitch;
    size_t j = 0;
    for (; j + 8 <= count; j += 8) {
        const auto north = [&](size_t i) { return plane + index[j + i]; };
        const auto south = [&](size_t i) { return plane_south + index[j + i]; };
        prefetch(south(3) + pitch);
        prefetch(south(7) + pitch);
        // In halves of four values: points 0, 1 and 4, 5; points 2, 3 and 6, 7.
        EightFloats near;
        EightFloats far;
        EightFloats part;
        EightFloats down;
        std::memcpy(&down, fz + j, sizeof down);
        take_pairs(north, 0, 1, 4, 5, near);
        take_pairs(south, 0, 1, 4, 5, far);
        shuffle<0, 0, 1, 1, 4, 4, 5, 5>(down, down, part);
        const EightFloats a = near + (far - near) * part;
        take_pairs(north, 2, 3, 6, 7, near);
        take_pairs(south, 2, 3, 6, 7, far);
        shuffle<2, 2, 3, 3, 6, 6, 7, 7>(down, down, part);
        const EightFloats b = near + (far - near) * part;
        EightFloats west;
        EightFloats east;
        EightFloats across;
        shuffle<0, 2, 8, 10, 4, 6, 12, 14>(a, b, west);
        shuffle<1, 3, 9, 11, 5, 7, 13, 15>(a, b, east);
        std::memcpy(&across, fx + j, sizeof across);
        const EightFloats value = west + (east - west) * across;
        std::memcpy(out + j, &value, sizeof value);
    }
    for (; j < count; ++j) out[j] = value_at(plane + index[j], plane_south + index[j], fx[j], fz[j]);
}

/// 0 where the nearest of a point's four values is.
TROCHOID_WIDE_ROWS void clear_nearest(const float* __restrict plane, int32_t pitch,
                                      const int32_t* __restrict index, const float* __restrict fx,
                                      const float* __restrict fz, size_t count, float* __restrict out) {
    for (size_t j = 0; j < count; ++j) {
        const int32_t at = index[j] + (fz[j] >= 0.5F ? pitch : 0) + (fx[j] >= 0.5F ? 1 : 0);
        out[j] = plane[at] == 0.0F ? 0.0F : out[j];
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
    const auto from = static_cast<size_t>(range.from);
    sample_points(plane, pitch_, index_.data() + from, fx_.data() + from, fz_.data() + from,
                  static_cast<size_t>(range.to - range.from), out + from);
}

void PlaneSampler::sample_solid(const float* plane, IndexRange range, float* out) const {
    sample(plane, range, out);
    const auto from = static_cast<size_t>(range.from);
    clear_nearest(plane, static_cast<int32_t>(pitch_), index_.data() + from, fx_.data() + from,
                  fz_.data() + from, static_cast<size_t>(range.to - range.from), out + from);
}

}  // namespace trochoid
