#include "server/land/growth_limit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/wide_rows.hpp"

namespace trochoid {

namespace {

/// Every band may at least share in this part of the growth, however deep its water.
constexpr double least_excess = 0.05;

inline float squared(float value) { return value * value; }
inline float larger(float a, float b) { return a > b ? a : b; }

/// A row of nodes across its cells.
struct NodeRow {
    std::vector<float> along;   ///< squared wave number along x, per cell
    std::vector<float> height;  ///< per node
};

TROCHOID_WIDE_ROWS void square_slopes(const int32_t* __restrict from, const int32_t* __restrict to,
                                      size_t count, float k, float* __restrict out) {
    for (size_t x = 0; x < count; ++x) out[x] = squared(k + static_cast<float>(to[x] - from[x]) * 0x1p-16F);
}

TROCHOID_WIDE_ROWS void take_heights(const uint16_t* __restrict gain, size_t count, float* __restrict out) {
    for (size_t x = 0; x < count; ++x) out[x] = static_cast<float>(static_cast<int32_t>(gain[x])) * 0x1p-15F;
}

TROCHOID_WIDE_ROWS void take_orbits(const uint16_t* __restrict orbit, size_t count, float* __restrict out) {
    for (size_t x = 0; x < count; ++x)
        out[x] = out[x] * (static_cast<float>(static_cast<int32_t>(orbit[x])) * 0x1p-14F);
}

/// Squared growth of a row of cells, from the nodes above and below.
TROCHOID_WIDE_ROWS void grow_cells(const float* __restrict upper, const float* __restrict lower,
                                   const float* __restrict upper_height, const float* __restrict lower_height,
                                   const float* __restrict down, size_t count, float per_k_square,
                                   float* __restrict out) {
    for (size_t x = 0; x < count; ++x) {
        const float k_square = larger(upper[x], lower[x]) + larger(down[x], down[x + 1]);
        const float height = larger(larger(upper_height[x], upper_height[x + 1]),
                                    larger(lower_height[x], lower_height[x + 1]));
        out[x] = squared(height) * (k_square * per_k_square);
    }
}

TROCHOID_WIDE_ROWS void take_larger(float* __restrict most, const float* __restrict values, size_t count) {
    for (size_t x = 0; x < count; ++x) most[x] = larger(most[x], values[x]);
}

/// Squared growth of cells: the bilinear shift's slopes lie between those of the cell's edges.
class CellGrowth {
public:
    CellGrowth(const NodeField& field, const LandArea& area, const WaveBand& band, bool with_orbit)
        : field_(field),
          nx_(static_cast<size_t>(area.nodes_x())),
          kx_(static_cast<float>(band.steep_turns_per_metre * area.step() * band.dx)),
          kz_(static_cast<float>(band.steep_turns_per_metre * area.step() * band.dz)),
          per_k_square_(1.0F / squared(static_cast<float>(band.steep_turns_per_metre * area.step()))),
          with_orbit_(with_orbit),
          upper_{std::vector<float>(nx_), std::vector<float>(nx_)},
          lower_(upper_),
          down_(nx_),
          cells_(nx_) {}

    /// The sixteen rows of `count` cells from node `start` on: each(row, cells).
    template <class Each>
    void rows(size_t start, size_t count, const Each& each) {
        take(start, count, upper_);
        for (size_t z = 0; z < block_cells; ++z) {
            const size_t n = start + z * nx_;
            take(n + nx_, count, lower_);
            const int32_t* const shift = field_.shift.data() + n;
            square_slopes(shift, shift + nx_, count + 1, kz_, down_.data());
            grow_cells(upper_.along.data(), lower_.along.data(), upper_.height.data(), lower_.height.data(),
                       down_.data(), count, per_k_square_, cells_.data());
            each(z, cells_.data());
            std::swap(upper_, lower_);
        }
    }

private:
    void take(size_t n, size_t count, NodeRow& row) const {
        const int32_t* const shift = field_.shift.data() + n;
        square_slopes(shift, shift + 1, count, kx_, row.along.data());
        take_heights(field_.gain.data() + n, count + 1, row.height.data());
        if (with_orbit_) take_orbits(field_.orbit.data() + n, count + 1, row.height.data());
    }

    const NodeField& field_;
    size_t nx_;
    float kx_;
    float kz_;
    float per_k_square_;
    bool with_orbit_;
    NodeRow upper_;
    NodeRow lower_;
    std::vector<float> down_;
    std::vector<float> cells_;
};

/// The cells of a block with those around it.
constexpr size_t padded_side = block_cells + 2;

/// The largest of each node's four cells, for the nodes of a block.
TROCHOID_WIDE_ROWS void take_worst(const float* __restrict cells, float* __restrict worst) {
    for (size_t z = 0; z < block_nodes; ++z) {
        const float* const upper = cells + z * padded_side;
        const float* const lower = upper + padded_side;
        float* const out = worst + z * block_nodes;
        for (size_t x = 0; x < block_nodes; ++x)
            out[x] = larger(larger(upper[x], upper[x + 1]), larger(lower[x], lower[x + 1]));
    }
}

}  // namespace

class GrowthLimiter {
public:
    GrowthLimiter(NodeField& field, const LandArea& area, std::span<const uint8_t> live, const WaveBand& band)
        : field_(field),
          area_(area),
          live_(live),
          band_(band),
          plain_(field, area, band, false),
          most_(static_cast<size_t>(area.nodes_x())),
          slot_(live.size(), -1) {}

    /// Measures a row's live blocks; returns the largest.
    float measure(std::vector<float>& blocks, int32_t bz) {
        return measure(plain_, blocks, bz, [&](size_t at) { return live_[at] != 0; });
    }
    /// Measures all live blocks with their orbits; returns the largest.
    float measure_orbits(std::vector<float>& blocks) {
        CellGrowth growth(field_, area_, band_, true);
        float largest = 1.0F;
        for (int32_t bz = 0; bz < area_.blocks_z; ++bz)
            largest =
                std::max(largest, measure(growth, blocks, bz, [&](size_t at) { return live_[at] != 0; }));
        return largest;
    }
    /// Measures again what `lower` may have changed.
    void measure_lowered(std::vector<float>& blocks, bool with_orbit) {
        std::vector<uint8_t> changed(live_.size(), 0);
        for (const Block& block : above_)
            for_around(block, [&](size_t at, size_t, size_t) { changed[at] = live_[at]; });
        CellGrowth growth(field_, area_, band_, with_orbit);
        for (int32_t bz = 0; bz < area_.blocks_z; ++bz)
            measure(growth, blocks, bz, [&](size_t at) { return changed[at] != 0; });
    }

    /// Lowers gains, or orbits down to 1, at the nodes of cells above the limit.
    uint64_t lower(const std::vector<float>& blocks, float limit_square, bool orbits) {
        for (const Block& block : above_) slot_[index_of(block)] = -1;
        above_.clear();
        cells_.clear();
        CellGrowth growth(field_, area_, band_, orbits);
        uint64_t count = 0;
        for (int32_t bz = 0; bz < area_.blocks_z; ++bz)
            for (int32_t bx = 0; bx < area_.blocks_x; ++bx) {
                const Block block{bx, bz};
                const size_t at = index_of(block);
                if (live_[at] == 0 || blocks[at] <= limit_square) continue;
                slot_[at] = static_cast<int32_t>(above_.size());
                above_.push_back(block);
                growth.rows(block_start(area_, bx, bz), block_cells, [&](size_t, const float* cells) {
                    cells_.insert(cells_.end(), cells, cells + block_cells);
                    for (size_t x = 0; x < block_cells; ++x) count += cells[x] > limit_square ? 1U : 0U;
                });
            }
        // Every node once, from the cells as they were.
        for (const Block& block : above_) lower_block(block, limit_square, orbits);
        return count;
    }

private:
    static constexpr size_t cells_per_block = size_t{block_cells} * block_cells;
    static constexpr size_t padded = padded_side;
    using Padded = std::array<float, padded * padded>;
    struct Block {
        int32_t x;
        int32_t z;
    };

    size_t index_of(const Block& block) const {
        return static_cast<size_t>(block.z) * static_cast<size_t>(area_.blocks_x) +
               static_cast<size_t>(block.x);
    }
    bool is_above(int32_t bx, int32_t bz) const {
        return bx >= 0 && bz >= 0 && bx < area_.blocks_x && bz < area_.blocks_z &&
               slot_[index_of({bx, bz})] >= 0;
    }
    /// The block and its neighbours: each(index, column, row) with column and row 0 to 2, 1 in the middle.
    template <class Each>
    void for_around(const Block& block, const Each& each) const {
        for (int32_t bz = std::max(block.z - 1, 0); bz <= std::min(block.z + 1, area_.blocks_z - 1); ++bz)
            for (int32_t bx = std::max(block.x - 1, 0); bx <= std::min(block.x + 1, area_.blocks_x - 1); ++bx)
                each(index_of({bx, bz}), static_cast<size_t>(bx - block.x + 1),
                     static_cast<size_t>(bz - block.z + 1));
    }

    /// Neighbouring blocks of a row are measured together.
    template <class Wanted>
    float measure(CellGrowth& growth, std::vector<float>& blocks, int32_t bz, const Wanted& wanted) {
        float largest = 1.0F;
        for (int32_t from = 0; from < area_.blocks_x; ++from) {
            if (!wanted(index_of({from, bz}))) continue;
            int32_t to = from + 1;
            while (to < area_.blocks_x && wanted(index_of({to, bz}))) ++to;
            const size_t count = static_cast<size_t>(to - from) * block_cells;
            std::fill_n(most_.begin(), count, 1.0F);
            growth.rows(block_start(area_, from, bz), count,
                        [&](size_t, const float* cells) { take_larger(most_.data(), cells, count); });
            const float* block = most_.data();
            for (int32_t bx = from; bx < to; ++bx, block += block_cells) {
                float& of_block = blocks[index_of({bx, bz})];
                of_block = *std::max_element(block, block + block_cells);
                largest = std::max(largest, of_block);
            }
            from = to;
        }
        return largest;
    }

    /// Cells above the limit around and in a block; all others read the limit.
    void pad(Padded& cells, const Block& block, float limit_square) const {
        cells.fill(limit_square);
        for_around(block, [&](size_t at, size_t column, size_t row) {
            if (slot_[at] < 0) return;
            const float* const from = cells_.data() + static_cast<size_t>(slot_[at]) * cells_per_block;
            // First and last of the padded cells that the neighbour holds, and its first.
            constexpr std::array<size_t, 3> first{0, 1, padded - 1};
            constexpr std::array<size_t, 3> count{1, block_cells, 1};
            constexpr std::array<size_t, 3> skipped{block_cells - 1, 0, 0};
            for (size_t z = 0; z < count[row]; ++z)
                for (size_t x = 0; x < count[column]; ++x)
                    cells[(first[row] + z) * padded + first[column] + x] =
                        from[(skipped[row] + z) * block_cells + skipped[column] + x];
        });
    }

    /// All nodes of the block but those that a later block above the limit has too.
    void lower_block(const Block& block, float limit_square, bool orbits) {
        Padded cells;
        pad(cells, block, limit_square);
        const bool east = is_above(block.x + 1, block.z);
        const bool south = is_above(block.x, block.z + 1);
        const bool south_east = is_above(block.x + 1, block.z + 1);
        const bool south_west = is_above(block.x - 1, block.z + 1);
        std::array<float, size_t{block_nodes} * block_nodes> all_worst;
        take_worst(cells.data(), all_worst.data());
        for (size_t z = 0; z < block_nodes; ++z) {
            const size_t n = block_start(area_, block.x, block.z) + z * static_cast<size_t>(area_.nodes_x());
            const bool last_row = z + 1 == block_nodes;
            if (last_row && south) break;
            const float* const worst = all_worst.data() + z * block_nodes;
            for (size_t x = 0; x < block_nodes; ++x) {
                if (worst[x] <= limit_square) continue;
                const bool last = x + 1 == block_nodes;
                if (last && (east || (last_row && south_east))) continue;
                if (last_row && x == 0 && south_west) continue;
                lower_node(n + x, limit_square / worst[x], orbits);
            }
        }
    }

    void lower_node(size_t n, float factor_square, bool orbits) {
        const bool open = field_.gain[n] == unit_node_gain && field_.shift[n] == 0;
        if (open && (field_.orbit.empty() || field_.orbit[n] == unit_node_orbit)) return;
        const float factor = std::sqrt(factor_square);
        uint16_t& lowered = orbits ? field_.orbit[n] : field_.gain[n];
        const auto value = static_cast<uint16_t>(static_cast<float>(lowered) * factor);
        lowered = orbits ? std::max(value, std::min(lowered, unit_node_orbit)) : value;
    }

    NodeField& field_;
    const LandArea& area_;
    std::span<const uint8_t> live_;
    const WaveBand& band_;
    CellGrowth plain_;
    std::vector<float> most_;
    /// Blocks above the limit, their cells one after the other, and where in those a block's lie (-1: nowhere).
    std::vector<Block> above_;
    std::vector<float> cells_;
    std::vector<int32_t> slot_;
};

std::vector<double> growth_allowances(std::span<const WaveBand> bands, std::span<const double> unlimited,
                                      double growth_max) {
    double weights = 0.0;
    double excess = 0.0;
    for (size_t i = 0; i < bands.size(); ++i) {
        weights = weights + bands[i].steepness;
        excess = excess + bands[i].steepness * (unlimited[i] - 1.0 + least_excess);
    }
    std::vector<double> allowed;
    for (size_t i = 0; i < bands.size(); ++i)
        allowed.push_back(excess > 0.0 ? 1.0 + (growth_max - 1.0) * (unlimited[i] - 1.0 + least_excess) *
                                                   weights / excess
                                       : growth_max);
    return allowed;
}

GrowthLimit::GrowthLimit(NodeField& field, const LandArea& area, std::span<const uint8_t> live,
                         const WaveBand& band, double allowed)
    : field_(field),
      limiter_(std::make_unique<GrowthLimiter>(field, area, live, band)),
      limit_square_(static_cast<float>(allowed * allowed)) {
    result_.squared.assign(live.size(), 1.0F);
}

GrowthLimit::~GrowthLimit() = default;

void GrowthLimit::measure(int32_t bz) {
    largest_ = std::max(largest_, limiter_->measure(result_.squared, bz));
}

BandGrowth GrowthLimit::limited() {
    if (largest_ > limit_square_) {
        result_.limited_cells = limiter_->lower(result_.squared, limit_square_, false);
        if (field_.orbit.empty()) limiter_->measure_lowered(result_.squared, false);
    }
    if (!field_.orbit.empty() && limiter_->measure_orbits(result_.squared) > limit_square_) {
        result_.limited_cells += limiter_->lower(result_.squared, limit_square_, true);
        limiter_->measure_lowered(result_.squared, true);
    }
    return std::move(result_);
}

}  // namespace trochoid
