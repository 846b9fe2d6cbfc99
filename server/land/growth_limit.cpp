#include "server/land/growth_limit.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

double squared(double value) { return value * value; }

size_t node(int32_t x, int32_t z) { return static_cast<size_t>(z * block_nodes + x); }

/// gain * |k'| / k in a cell of a block, at its steepest: the bilinear shift's slopes lie between those of the cell's edges.
double cell_growth(const LandBlock& block, int32_t x, int32_t z, const WaveBand& band, double k) {
    const size_t n00 = node(x, z);
    const size_t n10 = node(x + 1, z);
    const size_t n01 = node(x, z + 1);
    const size_t n11 = node(x + 1, z + 1);
    const uint16_t gain =
        std::max(std::max(block.gain[n00], block.gain[n10]), std::max(block.gain[n01], block.gain[n11]));
    if (gain == 0) return 0.0;
    const auto slope = [&](size_t from, size_t to) {
        return static_cast<double>(block.shift[to] - block.shift[from]) * 0x1p-16;
    };
    const double kx = k * band.dx;
    const double kz = k * band.dz;
    const double x_square = std::max(squared(kx + slope(n00, n10)), squared(kx + slope(n01, n11)));
    const double z_square = std::max(squared(kz + slope(n00, n01)), squared(kz + slope(n10, n11)));
    return static_cast<double>(gain) / 32768.0 * (std::sqrt(x_square + z_square) / k);
}

/// Growth of every cell of the area, row-major.
class CellGrowth {
public:
    CellGrowth(const LandArea& area, std::span<const BandBlocks> bands)
        : area_(area), columns_(area.blocks_x * block_cells), rows_(area.blocks_z * block_cells) {
        double open = 0.0;
        for (const BandBlocks& b : bands) open = open + b.band->steepness;
        cells_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), 1.0);
        for (const BandBlocks& b : bands)
            if (b.band->steepness > 0.0) add(b, b.band->steepness / open);
    }

    const std::vector<double>& cells() const { return cells_; }

    /// What a node's gains are to be multiplied by so that no cell around it exceeds the limit.
    double factor(const BlockKey& key, int32_t x, int32_t z, double limit) const {
        const int32_t column = (key.x - area_.first.x) * block_cells + x;
        const int32_t row = (key.z - area_.first.z) * block_cells + z;
        double worst = limit;
        for (int32_t r = std::max(row - 1, 0); r <= std::min(row, rows_ - 1); ++r)
            for (int32_t c = std::max(column - 1, 0); c <= std::min(column, columns_ - 1); ++c)
                worst = std::max(worst, cells_[index(c, r)]);
        return limit / worst;
    }

private:
    size_t index(int32_t column, int32_t row) const {
        return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
    }

    void add(const BandBlocks& b, double share) {
        const double k = b.band->steep_turns_per_metre * area_.step();
        for (const auto& block : b.blocks) {
            const int32_t column = (block->key.x - area_.first.x) * block_cells;
            const int32_t row = (block->key.z - area_.first.z) * block_cells;
            for (int32_t z = 0; z < block_cells; ++z)
                for (int32_t x = 0; x < block_cells; ++x) {
                    double& cell = cells_[index(column + x, row + z)];
                    cell = cell + share * (cell_growth(*block, x, z, *b.band, k) - 1.0);
                }
        }
    }

    const LandArea& area_;
    int32_t columns_;
    int32_t rows_;
    std::vector<double> cells_;
};

void lower(LandBlock& block, const CellGrowth& growth, double limit) {
    for (int32_t z = 0; z < block_nodes; ++z) {
        for (int32_t x = 0; x < block_nodes; ++x) {
            const size_t n = node(x, z);
            if (block.gain[n] == unit_node_gain && block.shift[n] == 0) continue;
            const double factor = growth.factor(block.key, x, z, limit);
            if (factor < 1.0)
                block.gain[n] = static_cast<uint16_t>(static_cast<double>(block.gain[n]) * factor);
        }
    }
}

double largest(const std::vector<double>& cells) {
    double most = 1.0;
    for (const double cell : cells) most = std::max(most, cell);
    return most;
}

}  // namespace

GrowthLimit limit_growth(const LandArea& area, std::span<BandBlocks> bands, double growth_max) {
    GrowthLimit result;
    const CellGrowth before(area, bands);
    result.growth = largest(before.cells());
    if (result.growth <= growth_max) return result;
    for (const double cell : before.cells())
        if (cell > growth_max) ++result.limited_cells;
    for (const BandBlocks& b : bands)
        for (const auto& block : b.blocks) lower(*block, before, growth_max);
    result.growth = largest(CellGrowth(area, bands).cells());
    return result;
}

}  // namespace trochoid
