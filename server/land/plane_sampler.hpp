#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/land/bilinear.hpp"
#include "server/land/tile_marks.hpp"

namespace trochoid {

/// A straight row of points over a plane, Q.32: point j lies at (x + j * dx, z + j * dz), |dx|, |dz| <= 1.
struct ObliqueRow {
    int64_t x = 0;
    int64_t z = 0;
    int64_t dx = 0;
    int64_t dz = 0;

    int32_t x_of(int32_t j) const { return static_cast<int32_t>((x + j * dx) >> 32); }
    int32_t z_of(int32_t j) const { return static_cast<int32_t>((z + j * dz) >> 32); }
};

/// Takes rows of points out of planes, row after row; every point's cell and weights are worked out once for all planes.
class PlaneSampler {
public:
    /// Places the points j of `inside`, all within the plane, whose rows are `pitch` values apart.
    void place(const ObliqueRow& row, IndexRange inside, size_t pitch);
    /// out[j] = the bilinear value of `plane` at point j, for the j of `range`, part of what was placed: between the rows first, with
    /// equal values staying exactly equal.
    void sample(const float* plane, IndexRange range, float* out) const;
    /// The same, but 0 where the nearest of the four is, so that what is one point wide has no holes.
    void sample_solid(const float* plane, IndexRange range, float* out) const;

private:
    size_t pitch_ = 0;
    std::vector<int32_t> index_;
    std::vector<float> fx_;
    std::vector<float> fz_;
};

/// Parts of `inside` whose points and their neighbours to the south-east have the same spread marks (TileMarks::spread):
/// each(range, marks). |dx|, |dz| <= 1.
template <class Each>
void for_marked_runs(const TileMarks& marks, const ObliqueRow& row, IndexRange inside, const Each& each) {
    const auto marks_of = [&](int32_t j) { return marks.at(row.x_of(j), row.z_of(j)); };
    for (int32_t from = inside.from; from < inside.to;) {
        const uint8_t here = marks_of(from);
        int32_t to = from + TileMarks::side;
        while (to < inside.to && marks_of(to) == here) to += TileMarks::side;
        to = to < inside.to ? to : inside.to;
        each(IndexRange{from, to}, here);
        from = to;
    }
}

}  // namespace trochoid
