#include "server/land/growth_limit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

/// Every band may at least share in this part of the growth, however deep its water.
constexpr double least_excess = 0.05;

inline float squared(float value) { return value * value; }
inline float larger(float a, float b) { return a > b ? a : b; }

/// Squared growth of cells: the bilinear shift's slopes lie between those of the cell's edges.
class CellGrowth {
public:
    CellGrowth(const NodeField& field, const LandArea& area, const WaveBand& band, bool with_orbit)
        : field_(field),
          nx_(static_cast<size_t>(area.nodes_x())),
          kx_(static_cast<float>(band.steep_turns_per_metre * area.step() * band.dx)),
          kz_(static_cast<float>(band.steep_turns_per_metre * area.step() * band.dz)),
          per_k_square_(1.0F / squared(static_cast<float>(band.steep_turns_per_metre * area.step()))),
          with_orbit_(with_orbit) {}

    /// The cells of a block, row-major; returns their largest.
    float block(size_t start, std::array<float, block_cells * block_cells>& cells) const {
        std::array<float, block_cells> upper;
        std::array<float, block_cells> lower;
        std::array<float, block_nodes> upper_height;
        std::array<float, block_nodes> lower_height;
        std::array<float, block_nodes> down;
        along_x(start, upper);
        heights(start, upper_height);
        std::array<float, block_cells> largest{};
        for (size_t z = 0; z < block_cells; ++z) {
            const size_t n = start + z * nx_;
            along_x(n + nx_, lower);
            heights(n + nx_, lower_height);
            const int32_t* const here = field_.shift.data() + n;
            const int32_t* const below = here + nx_;
            for (size_t x = 0; x < block_nodes; ++x)
                down[x] = squared(kz_ + static_cast<float>(below[x] - here[x]) * 0x1p-16F);
            float* const out = cells.data() + z * block_cells;
            for (size_t x = 0; x < block_cells; ++x) {
                const float k_square = larger(upper[x], lower[x]) + larger(down[x], down[x + 1]);
                const float height = larger(larger(upper_height[x], upper_height[x + 1]),
                                            larger(lower_height[x], lower_height[x + 1]));
                out[x] = squared(height) * (k_square * per_k_square_);
                largest[x] = larger(largest[x], out[x]);
            }
            upper = lower;
            upper_height = lower_height;
        }
        return *std::max_element(largest.begin(), largest.end());
    }

private:
    void along_x(size_t n, std::array<float, block_cells>& out) const {
        const int32_t* const here = field_.shift.data() + n;
        for (size_t x = 0; x < block_cells; ++x)
            out[x] = squared(kx_ + static_cast<float>(here[x + 1] - here[x]) * 0x1p-16F);
    }
    void heights(size_t n, std::array<float, block_nodes>& out) const {
        const uint16_t* const gain = field_.gain.data() + n;
        for (size_t x = 0; x < block_nodes; ++x)
            out[x] = static_cast<float>(static_cast<int32_t>(gain[x])) * 0x1p-15F;
        if (!with_orbit_) return;
        const uint16_t* const orbit = field_.orbit.data() + n;
        for (size_t x = 0; x < block_nodes; ++x)
            out[x] = out[x] * (static_cast<float>(static_cast<int32_t>(orbit[x])) * 0x1p-14F);
    }

    const NodeField& field_;
    size_t nx_;
    float kx_;
    float kz_;
    float per_k_square_;
    bool with_orbit_;
};

class Limiter {
public:
    Limiter(NodeField& field, const LandArea& area, std::span<const uint8_t> live, const WaveBand& band)
        : field_(field), area_(area), live_(live), band_(band) {}

    /// Measures all live blocks; returns the largest.
    float measure(std::vector<float>& blocks, bool with_orbit) {
        const CellGrowth growth(field_, area_, band_, with_orbit);
        std::array<float, block_cells * block_cells> cells;
        float largest = 1.0F;
        for_live([&](int32_t bx, int32_t bz, size_t at) {
            blocks[at] = std::max(growth.block(block_start(area_, bx, bz), cells), 1.0F);
            largest = std::max(largest, blocks[at]);
        });
        return largest;
    }

    /// Lowers gains, or orbits down to 1, at the nodes of cells above the limit.
    uint64_t lower(const std::vector<float>& blocks, float limit_square, bool orbits) {
        const size_t columns = static_cast<size_t>(area_.blocks_x) * block_cells;
        cells_.assign(columns * static_cast<size_t>(area_.blocks_z) * block_cells, 1.0F);
        const CellGrowth growth(field_, area_, band_, orbits);
        std::array<float, block_cells * block_cells> cells;
        uint64_t above = 0;
        for_live([&](int32_t bx, int32_t bz, size_t at) {
            if (blocks[at] <= limit_square) return;
            growth.block(block_start(area_, bx, bz), cells);
            for (size_t z = 0; z < block_cells; ++z) {
                float* const to = cells_.data() + (static_cast<size_t>(bz) * block_cells + z) * columns +
                                  static_cast<size_t>(bx) * block_cells;
                std::copy_n(cells.begin() + static_cast<std::ptrdiff_t>(z * block_cells), block_cells, to);
                for (size_t x = 0; x < block_cells; ++x) above += to[x] > limit_square ? 1U : 0U;
            }
        });
        // Every node once, from the cells as they were.
        done_.assign(static_cast<size_t>(area_.nodes_x()) * static_cast<size_t>(area_.nodes_z()), 0);
        for_live([&](int32_t bx, int32_t bz, size_t at) {
            if (blocks[at] <= limit_square) return;
            for (int32_t z = bz * block_cells; z <= (bz + 1) * block_cells; ++z)
                for (int32_t x = bx * block_cells; x <= (bx + 1) * block_cells; ++x)
                    lower_node(x, z, limit_square, orbits);
        });
        return above;
    }

private:
    template <class Each>
    void for_live(const Each& each) const {
        size_t at = 0;
        for (int32_t bz = 0; bz < area_.blocks_z; ++bz)
            for (int32_t bx = 0; bx < area_.blocks_x; ++bx, ++at)
                if (live_[at] != 0) each(bx, bz, at);
    }

    void lower_node(int32_t x, int32_t z, float limit_square, bool orbits) {
        const int32_t columns = area_.blocks_x * block_cells;
        const int32_t rows = area_.blocks_z * block_cells;
        const size_t n =
            static_cast<size_t>(z) * static_cast<size_t>(area_.nodes_x()) + static_cast<size_t>(x);
        if (done_[n] != 0) return;
        done_[n] = 1;
        float worst = limit_square;
        for (int32_t r = std::max(z - 1, 0); r <= std::min(z, rows - 1); ++r)
            for (int32_t c = std::max(x - 1, 0); c <= std::min(x, columns - 1); ++c)
                worst = std::max(
                    worst,
                    cells_[static_cast<size_t>(r) * static_cast<size_t>(columns) + static_cast<size_t>(c)]);
        if (worst <= limit_square) return;
        const bool open = field_.gain[n] == unit_node_gain && field_.shift[n] == 0;
        if (open && (field_.orbit.empty() || field_.orbit[n] == unit_node_orbit)) return;
        const float factor = std::sqrt(limit_square / worst);
        uint16_t& lowered = orbits ? field_.orbit[n] : field_.gain[n];
        const auto value = static_cast<uint16_t>(static_cast<float>(lowered) * factor);
        lowered = orbits ? std::max(value, std::min(lowered, unit_node_orbit)) : value;
    }

    NodeField& field_;
    const LandArea& area_;
    std::span<const uint8_t> live_;
    const WaveBand& band_;
    std::vector<float> cells_;
    std::vector<uint8_t> done_;
};

}  // namespace

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

BandGrowth limit_growth(NodeField& field, const LandArea& area, std::span<const uint8_t> live,
                        const WaveBand& band, double allowed) {
    BandGrowth result;
    result.squared.assign(live.size(), 1.0F);
    Limiter limiter(field, area, live, band);
    const auto limit_square = static_cast<float>(allowed * allowed);
    if (limiter.measure(result.squared, false) > limit_square) {
        result.limited_cells = limiter.lower(result.squared, limit_square, false);
        if (field.orbit.empty()) limiter.measure(result.squared, false);
    }
    if (field.orbit.empty()) return result;
    if (limiter.measure(result.squared, true) > limit_square) {
        result.limited_cells += limiter.lower(result.squared, limit_square, true);
        limiter.measure(result.squared, true);
    }
    return result;
}

}  // namespace trochoid
