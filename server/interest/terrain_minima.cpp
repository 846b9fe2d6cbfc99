#include "server/interest/terrain_minima.hpp"

#include <algorithm>

#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

constexpr int base_log2 = 4;  // cells along a side of the pyramid's lowest squares

}  // namespace

TerrainMinima::TerrainMinima(std::shared_ptr<const TerrainGrid> grid) : grid_(std::move(grid)) {
    const char* fault = terrain_fault(*grid_);
    TROCHOID_ASSERT(fault == nullptr, "terrain: {}", fault);
    const int64_t last_column = int64_t{grid_->columns} - 2;
    const int64_t last_row = int64_t{grid_->rows} - 2;
    Level base{(last_column >> base_log2) + 1, (last_row >> base_log2) + 1, {}};
    for (int64_t z = 0; z < base.rows; ++z)
        for (int64_t x = 0; x < base.columns; ++x)
            base.lowest.push_back(
                lowest_in({x << base_log2, z << base_log2, std::min(((x + 1) << base_log2) - 1, last_column),
                           std::min(((z + 1) << base_log2) - 1, last_row)}));
    levels_.push_back(std::move(base));
    while (levels_.back().columns > 1 || levels_.back().rows > 1) {
        const Level& fine = levels_.back();
        Level coarse{(fine.columns + 1) / 2, (fine.rows + 1) / 2, {}};
        for (int64_t z = 0; z < coarse.rows; ++z)
            for (int64_t x = 0; x < coarse.columns; ++x) {
                int16_t lowest = INT16_MAX;
                for (int64_t j = 2 * z; j < std::min(2 * z + 2, fine.rows); ++j)
                    for (int64_t i = 2 * x; i < std::min(2 * x + 2, fine.columns); ++i)
                        lowest = std::min(lowest, fine.lowest[static_cast<size_t>(j * fine.columns + i)]);
                coarse.lowest.push_back(lowest);
            }
        levels_.push_back(std::move(coarse));
    }
}

int16_t TerrainMinima::lowest_in(const CellRange& cells) const {
    int16_t lowest = INT16_MAX;
    for (int64_t row = cells.first_row; row <= cells.last_row + 1; ++row) {
        const auto* line = grid_->heights.data() + row * int64_t{grid_->columns};
        lowest = std::min(lowest, *std::min_element(line + cells.first_column, line + cells.last_column + 2));
    }
    return lowest;
}

bool TerrainMinima::above(size_t level, int64_t column, int64_t row, const CellRange& cells,
                          int64_t count) const {
    const int shift = base_log2 + static_cast<int>(level);
    const CellRange mine{column << shift, row << shift, ((column + 1) << shift) - 1,
                         ((row + 1) << shift) - 1};
    if (mine.first_column > cells.last_column || mine.last_column < cells.first_column ||
        mine.first_row > cells.last_row || mine.last_row < cells.first_row)
        return true;
    const Level& here = levels_[level];
    if (column >= here.columns || row >= here.rows) return true;
    if (here.lowest[static_cast<size_t>(row * here.columns + column)] > count) return true;
    if (level > 0) {
        for (int64_t child = 0; child < 4; ++child)
            if (!above(level - 1, 2 * column + (child & 1), 2 * row + (child >> 1), cells, count))
                return false;
        return true;
    }
    return lowest_in(
               {std::max(mine.first_column, cells.first_column), std::max(mine.first_row, cells.first_row),
                std::min(mine.last_column, cells.last_column), std::min(mine.last_row, cells.last_row)}) >
           count;
}

bool TerrainMinima::all_above(const LatticeRect& rect, int64_t height) const {
    const LatticePoint min{rect.min.x - grid_->origin_x, rect.min.z - grid_->origin_z};
    const LatticePoint max{rect.max.x - grid_->origin_x, rect.max.z - grid_->origin_z};
    const int64_t last_column = int64_t{grid_->columns} - 2;
    const int64_t last_row = int64_t{grid_->rows} - 2;
    const int64_t width = (last_column + 1) << grid_->spacing_log2;
    const int64_t depth = (last_row + 1) << grid_->spacing_log2;
    if (min.x < 0 || min.z < 0 || max.x > width || max.z > depth) return false;
    const CellRange cells{std::min(min.x >> grid_->spacing_log2, last_column),
                          std::min(min.z >> grid_->spacing_log2, last_row),
                          std::min(max.x >> grid_->spacing_log2, last_column),
                          std::min(max.z >> grid_->spacing_log2, last_row)};
    // A count is above the height where count << step > height, hence where count > height >> step.
    return above(levels_.size() - 1, 0, 0, cells, height >> grid_->height_step_log2);
}

}  // namespace trochoid
