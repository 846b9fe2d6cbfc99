#include "server/land/tile_marks.hpp"

#include <algorithm>
#include <limits>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/wide_rows.hpp"

namespace trochoid {

void TileMarks::reset(int32_t nx, int32_t nz) {
    tiles_x_ = ((nx - 1) >> side_log2) + 1;
    tiles_z_ = ((nz - 1) >> side_log2) + 1;
    marks_.assign(static_cast<size_t>(tiles_x_) * static_cast<size_t>(tiles_z_), 0);
}

void TileMarks::spread(uint8_t mark) {
    before_ = marks_;
    size_t n = 0;
    for (int32_t z = 0; z < tiles_z_; ++z)
        for (int32_t x = 0; x < tiles_x_; ++x, ++n) {
            if ((before_[n] & mark) != mark)
                for (int32_t r = std::max(z - 1, 0); r <= std::min(z + 1, tiles_z_ - 1); ++r)
                    for (int32_t c = std::max(x - 1, 0); c <= std::min(x + 1, tiles_x_ - 1); ++c)
                        marks_[n] |= static_cast<uint8_t>(
                            before_[static_cast<size_t>(r) * static_cast<size_t>(tiles_x_) +
                                    static_cast<size_t>(c)] &
                            mark);
        }
}

namespace {

TROCHOID_WIDE_ROWS void take_smaller(float* __restrict least, const float* __restrict values, size_t count) {
    for (size_t x = 0; x < count; ++x) least[x] = values[x] < least[x] ? values[x] : least[x];
}

}  // namespace

std::vector<float> tile_minima(std::span<const float> values, int32_t nx, int32_t nz) {
    TileMarks shape;
    shape.reset(nx, nz);
    const auto width = static_cast<size_t>(nx);
    std::vector<float> least;
    least.reserve(shape.tiles().size());
    std::vector<float> columns(width);
    for (int32_t z0 = 0; z0 < nz; z0 += TileMarks::side) {
        std::fill(columns.begin(), columns.end(), std::numeric_limits<float>::infinity());
        for (int32_t z = z0; z < std::min(z0 + TileMarks::side, nz); ++z)
            take_smaller(columns.data(), values.data() + static_cast<size_t>(z) * width, width);
        for (size_t x = 0; x < width; x += TileMarks::side)
            least.push_back(
                *std::min_element(columns.data() + x, columns.data() + std::min(x + TileMarks::side, width)));
    }
    return least;
}

}  // namespace trochoid
