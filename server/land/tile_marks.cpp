#include "server/land/tile_marks.hpp"

#include <algorithm>
#include <limits>

#include "protocol/model/arithmetic_rules.hpp"

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

std::vector<float> tile_minima(std::span<const float> values, int32_t nx, int32_t nz) {
    TileMarks shape;
    shape.reset(nx, nz);
    const auto tiles_x = static_cast<size_t>(shape.tiles_x());
    std::vector<float> least(shape.tiles().size(), std::numeric_limits<float>::infinity());
    for (int32_t z = 0; z < nz; ++z) {
        const float* const row = values.data() + static_cast<size_t>(z) * static_cast<size_t>(nx);
        float* const to = least.data() + static_cast<size_t>(z >> TileMarks::side_log2) * tiles_x;
        for (size_t tile = 0; tile < tiles_x; ++tile) {
            const size_t first = tile * TileMarks::side;
            const size_t last = std::min(first + TileMarks::side, static_cast<size_t>(nx));
            for (size_t x = first; x < last; ++x) to[tile] = std::min(to[tile], row[x]);
        }
    }
    return least;
}

}  // namespace trochoid
