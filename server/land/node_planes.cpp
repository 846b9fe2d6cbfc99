#include "server/land/node_planes.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/wide_rows.hpp"

namespace trochoid {

namespace {

constexpr int32_t most_passes = 8;

TROCHOID_WIDE_ROWS void limit_depths(const float* __restrict depths, size_t count, float shallowest,
                                     float deep, float* __restrict out) {
    for (size_t x = 0; x < count; ++x) out[x] = std::min(std::max(depths[x], shallowest), deep);
}

TROCHOID_WIDE_ROWS void open_on_land(const float* __restrict depths, size_t count, float open,
                                     float* __restrict wave_numbers) {
    for (size_t x = 0; x < count; ++x) wave_numbers[x] = depths[x] > 0.0F ? wave_numbers[x] : open;
}

/// (1 2 1) / 4 along a row of at least two; the outermost repeat.
TROCHOID_WIDE_ROWS void smooth_along(const float* __restrict row, size_t count, float* __restrict out) {
    out[0] = row[0] + 0.25F * (row[1] - row[0]);
    out[count - 1] = row[count - 1] + 0.25F * (row[count - 2] - row[count - 1]);
    for (size_t x = 1; x + 1 < count; ++x)
        out[x] = row[x] + 0.25F * ((row[x - 1] - row[x]) + (row[x + 1] - row[x]));
}

TROCHOID_WIDE_ROWS void smooth_across(const float* __restrict before, const float* __restrict here,
                                      const float* __restrict after, size_t count, float* __restrict out) {
    for (size_t x = 0; x < count; ++x)
        out[x] = here[x] + 0.25F * ((before[x] - here[x]) + (after[x] - here[x]));
}

/// One binomial pass (1 2 1) / 4 along both axes; the outermost nodes repeat. Written as differences so that equal values
/// stay exactly equal, and alike from both sides. `spare` holds three rows.
void smooth_once(float* values, size_t nx, size_t nz, float* spare) {
    float* before = spare;
    float* here = before + nx;
    float* after = here + nx;
    smooth_along(values, nx, here);
    std::copy_n(here, nx, before);
    for (size_t z = 0; z < nz; ++z) {
        float* const row = values + z * nx;
        if (z + 1 < nz)
            smooth_along(row + nx, nx, after);
        else
            std::copy_n(here, nx, after);
        smooth_across(before, here, after, nx, row);
        float* const passed = before;
        before = here;
        here = after;
        after = passed;
    }
}

/// One row of nodes after the other, tile by tile.
class RowPlanes {
public:
    RowPlanes(NodePlanes& planes, std::span<const float> depths, int32_t nx, float open,
              const DepthTable& table, bool straight, const PhaseDepths& phase_depths)
        : planes_(planes),
          depths_(depths),
          nx_(nx),
          open_(open),
          table_(table),
          straight_(straight),
          phase_depths_(phase_depths) {}

    void fill(int32_t z, bool with_limits) const {
        for (int32_t x = 0; x < nx_;) {
            const uint8_t marks = planes_.marks.at(x, z);
            int32_t to = x + TileMarks::side;
            while (to < nx_ && planes_.marks.at(to, z) == marks) to += TileMarks::side;
            to = std::min(to, nx_);
            fill({x, to}, z, marks, with_limits);
            x = to;
        }
    }
    /// The westernmost or easternmost node of the row that is touched; -1: none.
    int32_t touched(int32_t z, bool westernmost) const {
        const size_t row = static_cast<size_t>(z) * static_cast<size_t>(nx_);
        for (int32_t i = 0; i < nx_;) {
            const int32_t x = westernmost ? i : nx_ - 1 - i;
            const uint8_t marks = planes_.marks.at(x, z);
            if (marks == 0) {
                i += westernmost ? TileMarks::side - x % TileMarks::side : x % TileMarks::side + 1;
                continue;
            }
            if (((marks & NodePlanes::bends) != 0 && *phase_depths_.at(x, z) < table_.deep()) ||
                depths_[row + static_cast<size_t>(x)] < table_.untouched())
                return x;
            ++i;
        }
        return -1;
    }

private:
    void fill(IndexRange run, int32_t z, uint8_t marks, bool with_limits) const {
        const size_t n = static_cast<size_t>(z) * static_cast<size_t>(nx_) + static_cast<size_t>(run.from);
        const auto count = static_cast<size_t>(run.to - run.from);
        float* const wave_numbers = planes_.wave_numbers.data() + n;
        float* const limits = planes_.limits.data() + n;
        if ((marks & NodePlanes::bends) != 0)
            table_.wave_numbers(phase_depths_.at(run.from, z), count, open_, wave_numbers);
        else
            std::fill_n(wave_numbers, count, open_);
        if ((marks & NodePlanes::breaks) == 0) {
            if (with_limits) std::fill_n(limits, count, 1.0F);
            return;
        }
        table_.shares(depths_.data() + n, count, limits);
        if (straight_) open_on_land(depths_.data() + n, count, open_, wave_numbers);
    }

    NodePlanes& planes_;
    std::span<const float> depths_;
    int32_t nx_;
    float open_;
    const DepthTable& table_;
    bool straight_;
    const PhaseDepths& phase_depths_;
};

/// Whether a row of tiles has the mark, itself or up to `around` rows off.
bool row_has(TileMarks& marks, int32_t tile_row, int32_t around, uint8_t mark) {
    const int32_t first = std::max(tile_row - around, 0);
    const int32_t last = std::min(tile_row + around, marks.tiles_z() - 1);
    const auto tiles =
        marks.tiles().subspan(static_cast<size_t>(first) * static_cast<size_t>(marks.tiles_x()),
                              static_cast<size_t>(last - first + 1) * static_cast<size_t>(marks.tiles_x()));
    return std::any_of(tiles.begin(), tiles.end(), [&](uint8_t tile) { return (tile & mark) != 0; });
}

/// Nodes of a row of tiles from the first tile with the mark to the last; none: empty.
IndexRange columns_with(TileMarks& marks, int32_t tile_row, uint8_t mark, int32_t nx) {
    IndexRange columns{0, 0};
    for (int32_t x = 0; x < nx; x += TileMarks::side) {
        if ((marks.at(x, tile_row * TileMarks::side) & mark) == 0) continue;
        if (columns.to == 0) columns.from = x;
        columns.to = std::min(x + TileMarks::side, nx);
    }
    return columns;
}

}  // namespace

int32_t phase_depth_passes(const LandArea& area, const WaveBand& band) {
    // A pass has variance 1/2 node^2 along each axis: enough of them for a standard deviation of an eighth of a wave length.
    const double deviation = 0.125 / (band.turns_per_metre * area.step());
    return std::clamp(static_cast<int32_t>(std::min(2.0 * deviation * deviation, double{most_passes})), 1,
                      most_passes);
}

PhaseDepths::PhaseDepths(const LandArea& area, std::span<const float> depths, const WaveBand& band,
                         const DepthTable& table)
    : depths_(depths),
      nx_(area.nodes_x()),
      nz_(area.nodes_z()),
      shallowest_(table.shallowest()),
      deep_(table.deep()),
      passes_(phase_depth_passes(area, band)) {}

void PhaseDepths::take(NodeRows rows, IndexRange columns) {
    // Every pass spoils one node more from the part's sides inwards.
    first_row_ = std::max(rows.from - passes_, 0);
    first_column_ = std::max(columns.from - passes_, 0);
    const int32_t last_row = std::min(rows.to + passes_, nz_);
    width_ = static_cast<size_t>(std::min(columns.to + passes_, nx_) - first_column_);
    const auto height = static_cast<size_t>(last_row - first_row_);
    part_.resize(std::max(part_.size(), width_ * height));
    spare_.resize(std::max(spare_.size(), 3 * width_));
    for (int32_t z = first_row_; z < last_row; ++z)
        limit_depths(depths_.data() + static_cast<size_t>(z) * static_cast<size_t>(nx_) + first_column_,
                     width_, shallowest_, deep_, part_.data() + static_cast<size_t>(z - first_row_) * width_);
    for (int32_t pass = 0; pass < passes_; ++pass) smooth_once(part_.data(), width_, height, spare_.data());
}

void fill_node_planes(NodePlanes& planes, const LandArea& area, std::span<const float> depths,
                      std::span<const float> tile_depths, NodeRows filled, const WaveBand& band,
                      const DepthTable& table, bool straight) {
    // Runs of a march are sixteen points long, go by the tile of their first, and read one node around; marks are spread once
    // more for that.
    constexpr int32_t reach = 3;
    planes.wave_numbers.resize(depths.size());
    planes.limits.resize(depths.size());
    planes.touched = false;
    planes.marks.reset(area.nodes_x(), area.nodes_z());
    const std::span<uint8_t> tiles = planes.marks.tiles();
    for (size_t tile = 0; tile < tiles.size(); ++tile) {
        if (tile_depths[tile] < table.untouched()) tiles[tile] |= NodePlanes::bends;
        if (tile_depths[tile] < table.breaking()) tiles[tile] |= NodePlanes::breaks;
    }
    // Phase depths reach at most 8 nodes.
    planes.marks.spread(NodePlanes::bends);
    const auto open = static_cast<float>(band.turns_per_metre * area.step());
    PhaseDepths phase_depths(area, depths, band, table);
    const RowPlanes planes_of(planes, depths, area.nodes_x(), open, table, straight, phase_depths);
    for (int32_t tile_row = 0; tile_row < planes.marks.tiles_z(); ++tile_row) {
        const NodeRows rows{std::max(tile_row * TileMarks::side, filled.from),
                            std::min((tile_row + 1) * TileMarks::side, filled.to)};
        if (rows.from >= rows.to) continue;
        if (!row_has(planes.marks, tile_row, reach, NodePlanes::bends | NodePlanes::breaks)) continue;
        const IndexRange bent = columns_with(planes.marks, tile_row, NodePlanes::bends, area.nodes_x());
        if (bent.from < bent.to) phase_depths.take(rows, bent);
        const bool with_limits = row_has(planes.marks, tile_row, reach, NodePlanes::breaks);
        for (int32_t z = rows.from; z < rows.to; ++z) {
            planes_of.fill(z, with_limits);
            const int32_t nearest = planes_of.touched(z, band.dx >= 0.0);
            if (nearest < 0) continue;
            const double along = static_cast<double>(nearest) * band.dx + static_cast<double>(z) * band.dz;
            if (!planes.touched || along < planes.first_along) planes.first_along = along;
            planes.touched = true;
        }
    }
    planes.marks.spread(NodePlanes::bends | NodePlanes::breaks);
}

}  // namespace trochoid
