#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace trochoid {

/// What the points of a plane have that open water has not, by tiles of 16 x 16 points: rows leave out what they need not look at.
class TileMarks {
public:
    static constexpr int32_t side_log2 = 4;
    static constexpr int32_t side = 1 << side_log2;

    /// No marks on nx x nz points.
    void reset(int32_t nx, int32_t nz);
    void add(int32_t x, int32_t z, uint8_t mark) { marks_[index(x, z)] |= mark; }
    uint8_t at(int32_t x, int32_t z) const { return marks_[index(x, z)]; }
    /// Every tile also takes `mark` from its eight neighbours: a tile then tells of all points up to 16 away along either axis.
    void spread(uint8_t mark);
    /// The tiles' marks, row-major.
    std::span<uint8_t> tiles() { return marks_; }
    int32_t tiles_x() const { return tiles_x_; }
    int32_t tiles_z() const { return tiles_z_; }

private:
    size_t index(int32_t x, int32_t z) const {
        return static_cast<size_t>(z >> side_log2) * static_cast<size_t>(tiles_x_) +
               static_cast<size_t>(x >> side_log2);
    }

    int32_t tiles_x_ = 0;
    int32_t tiles_z_ = 0;
    std::vector<uint8_t> marks_;
    std::vector<uint8_t> before_;
};

/// Smallest value of each tile of 16 x 16 points, row-major.
std::vector<float> tile_minima(std::span<const float> values, int32_t nx, int32_t nz);

}  // namespace trochoid
