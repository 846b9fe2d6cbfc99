#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/model/terrain.hpp"
#include "protocol/units/lattice.hpp"

namespace trochoid {

/// Answers whether a rectangle lies wholly above some height, from a pyramid of minima over 16 x 16 cells and upwards.
class TerrainMinima {
public:
    explicit TerrainMinima(std::shared_ptr<const TerrainGrid> grid);

    const std::shared_ptr<const TerrainGrid>& grid() const { return grid_; }
    /// True where the rectangle lies inside the grid and the ground on all of it is higher than `height` (lattice units).
    bool all_above(const LatticeRect& rect, int64_t height) const;

private:
    struct Level {
        int64_t columns = 0;
        int64_t rows = 0;
        std::vector<int16_t> lowest;  // counts
    };
    /// Cells, inclusive on both ends.
    struct CellRange {
        int64_t first_column = 0, first_row = 0, last_column = 0, last_row = 0;
    };
    int16_t lowest_in(const CellRange& cells) const;
    bool above(size_t level, int64_t column, int64_t row, const CellRange& cells, int64_t count) const;

    std::shared_ptr<const TerrainGrid> grid_;
    std::vector<Level> levels_;
};

}  // namespace trochoid
