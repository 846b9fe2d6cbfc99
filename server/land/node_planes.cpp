#include "server/land/node_planes.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

/// One binomial pass (1 2 1) / 4 along both axes; the outermost nodes repeat. Written as differences so that equal values
/// stay exactly equal, and alike from both sides.
void smooth_once(std::span<float> values, std::vector<float>& temporary, size_t nx, size_t nz) {
    temporary.resize(2 * nx);
    float* const before = temporary.data();
    float* const here = before + nx;
    for (size_t z = 0; z < nz; ++z) {
        float* const row = values.data() + z * nx;
        std::copy_n(row, nx, here);
        row[0] = here[0] + 0.25F * (here[1] - here[0]);
        row[nx - 1] = here[nx - 1] + 0.25F * (here[nx - 2] - here[nx - 1]);
        for (size_t x = 1; x + 1 < nx; ++x)
            row[x] = here[x] + 0.25F * ((here[x - 1] - here[x]) + (here[x + 1] - here[x]));
    }
    std::copy_n(values.data(), nx, before);
    for (size_t z = 0; z < nz; ++z) {
        float* const row = values.data() + z * nx;
        const float* const after = values.data() + std::min(z + 1, nz - 1) * nx;
        for (size_t x = 0; x < nx; ++x) {
            const float mid = row[x];
            row[x] = mid + 0.25F * ((before[x] - mid) + (after[x] - mid));
            before[x] = mid;
        }
    }
}

/// One row of nodes after the other, tile by tile.
class RowPlanes {
public:
    RowPlanes(NodePlanes& planes, std::span<const float> depths, int32_t nx, float open,
              const DepthTable& table, bool straight)
        : planes_(planes), depths_(depths), nx_(nx), open_(open), table_(table), straight_(straight) {}

    void fill(int32_t z) const {
        const size_t row = static_cast<size_t>(z) * static_cast<size_t>(nx_);
        for (int32_t x = 0; x < nx_;) {
            const uint8_t marks = planes_.marks.at(x, z);
            int32_t to = x + TileMarks::side;
            while (to < nx_ && planes_.marks.at(to, z) == marks) to += TileMarks::side;
            to = std::min(to, nx_);
            fill(row + static_cast<size_t>(x), static_cast<size_t>(to - x), marks);
            x = to;
        }
    }
    /// The westernmost or easternmost node of the row that is touched; -1: none.
    int32_t touched(int32_t z, bool westernmost) const {
        const size_t row = static_cast<size_t>(z) * static_cast<size_t>(nx_);
        for (int32_t i = 0; i < nx_;) {
            const int32_t x = westernmost ? i : nx_ - 1 - i;
            if (planes_.marks.at(x, z) == 0) {
                i += westernmost ? TileMarks::side - x % TileMarks::side : x % TileMarks::side + 1;
                continue;
            }
            const size_t n = row + static_cast<size_t>(x);
            if (planes_.smooth[n] < table_.deep() || depths_[n] < table_.untouched()) return x;
            ++i;
        }
        return -1;
    }

private:
    void fill(size_t n, size_t count, uint8_t marks) const {
        float* const wave_numbers = planes_.wave_numbers.data() + n;
        float* const limits = planes_.limits.data() + n;
        if ((marks & NodePlanes::bends) != 0)
            table_.wave_numbers(planes_.smooth.data() + n, count, open_, wave_numbers);
        else
            std::fill_n(wave_numbers, count, open_);
        std::fill_n(limits, count, 1.0F);
        if ((marks & NodePlanes::breaks) == 0) return;
        for (size_t i = 0; i < count; ++i) {
            const float depth = depths_[n + i];
            if (depth >= table_.breaking()) continue;
            limits[i] = depth > 0.0F ? table_.at(depth)[3] : 0.0F;
            if (straight_ && depth <= 0.0F) wave_numbers[i] = open_;
        }
    }

    NodePlanes& planes_;
    std::span<const float> depths_;
    int32_t nx_;
    float open_;
    const DepthTable& table_;
    bool straight_;
};

}  // namespace

int32_t phase_depth_passes(const LandArea& area, const WaveBand& band) {
    // A pass has variance 1/2 node^2 along each axis: enough of them for a standard deviation of an eighth of a wave length.
    const double deviation = 0.125 / (band.turns_per_metre * area.step());
    return std::clamp(static_cast<int32_t>(std::min(2.0 * deviation * deviation, 8.0)), 1, 8);
}

void phase_depths(std::vector<float>& smooth, std::vector<float>& row, const LandArea& area,
                  std::span<const float> depths, NodeRows rows, const WaveBand& band,
                  const DepthTable& table) {
    smooth.resize(depths.size());
    const float shallowest = table.shallowest();
    const float deep = table.deep();
    const int32_t passes = phase_depth_passes(area, band);
    const auto nx = static_cast<size_t>(area.nodes_x());
    // Every pass spoils one row more from the ends inwards.
    const auto from = static_cast<size_t>(std::max(rows.from - passes, 0));
    const auto to = static_cast<size_t>(std::min(rows.to + passes, area.nodes_z()));
    for (size_t n = from * nx; n < to * nx; ++n) smooth[n] = std::min(std::max(depths[n], shallowest), deep);
    const std::span<float> part(smooth.data() + from * nx, (to - from) * nx);
    for (int32_t pass = 0; pass < passes; ++pass) smooth_once(part, row, nx, to - from);
}

void fill_node_planes(NodePlanes& planes, const LandArea& area, std::span<const float> depths,
                      std::span<const float> tile_depths, NodeRows filled, const WaveBand& band,
                      const DepthTable& table, bool straight) {
    phase_depths(planes.smooth, planes.row, area, depths, filled, band, table);
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
    const RowPlanes rows(planes, depths, area.nodes_x(), open, table, straight);
    for (int32_t z = filled.from; z < filled.to; ++z) {
        rows.fill(z);
        const int32_t nearest = rows.touched(z, band.dx >= 0.0);
        if (nearest < 0) continue;
        const double along = static_cast<double>(nearest) * band.dx + static_cast<double>(z) * band.dz;
        if (!planes.touched || along < planes.first_along) planes.first_along = along;
        planes.touched = true;
    }
    planes.marks.spread(NodePlanes::bends | NodePlanes::breaks);
}

}  // namespace trochoid
