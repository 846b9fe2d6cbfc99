#include "server/land/node_planes.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

/// One binomial pass (1 2 1) / 4 along both axes; the outermost nodes repeat. Written as differences so that equal values
/// stay exactly equal, and alike from both sides.
void smooth_once(std::vector<float>& values, std::vector<float>& temporary, size_t nx, size_t nz) {
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

/// One row of nodes; tells the first and last that are touched (from > to: none).
struct Touched {
    int32_t from;
    int32_t to;
};

Touched fill_row(float* pairs, const float* depths, const float* smooth, int32_t nx, float open,
                 const DepthTable& table, bool straight) {
    Touched touched{nx, -1};
    const float deep = table.deep();
    const float untouched = table.untouched();
    const float on_land = straight ? open : open * table.land()[0];
    for (int32_t x = 0; x < nx; ++x) {
        const float depth = depths[x];
        const float phase_depth = smooth[x];
        float wave_number = open;
        float limit = 1.0F;
        if (phase_depth < deep || depth < untouched) {
            touched.from = std::min(touched.from, x);
            touched.to = x;
            if (phase_depth < deep) wave_number = open * table.at(phase_depth)[0];
            if (depth <= 0.0F) {
                limit = 0.0F;
                if (straight) wave_number = on_land;
            } else if (depth < untouched) {
                limit = table.at(depth)[3];
            }
        }
        pairs[2 * x] = wave_number;
        pairs[2 * x + 1] = limit;
    }
    return touched;
}

}  // namespace

int32_t phase_depth_passes(const LandArea& area, const WaveBand& band) {
    // A pass has variance 1/2 node^2 along each axis: enough of them for a standard deviation of an eighth of a wave length.
    const double deviation = 0.125 / (band.turns_per_metre * area.step());
    return std::clamp(static_cast<int32_t>(std::min(2.0 * deviation * deviation, 8.0)), 1, 8);
}

void phase_depths(std::vector<float>& smooth, std::vector<float>& row, const LandArea& area,
                  std::span<const float> depths, const WaveBand& band, const DepthTable& table) {
    smooth.resize(depths.size());
    const float shallowest = table.shallowest();
    const float deep = table.deep();
    for (size_t n = 0; n < depths.size(); ++n) smooth[n] = std::min(std::max(depths[n], shallowest), deep);
    const int32_t passes = phase_depth_passes(area, band);
    for (int32_t pass = 0; pass < passes; ++pass)
        smooth_once(smooth, row, static_cast<size_t>(area.nodes_x()), static_cast<size_t>(area.nodes_z()));
}

void fill_node_planes(NodePlanes& planes, const LandArea& area, std::span<const float> depths,
                      const WaveBand& band, const DepthTable& table, bool straight) {
    phase_depths(planes.smooth, planes.row, area, depths, band, table);
    planes.pairs.resize(2 * depths.size());
    planes.touched = false;
    const auto open = static_cast<float>(band.turns_per_metre * area.step());
    const int32_t nx = area.nodes_x();
    for (int32_t z = 0; z < area.nodes_z(); ++z) {
        const size_t n = static_cast<size_t>(z) * static_cast<size_t>(nx);
        const Touched row = fill_row(planes.pairs.data() + 2 * n, depths.data() + n, planes.smooth.data() + n,
                                     nx, open, table, straight);
        if (row.from > row.to) continue;
        const int32_t nearest = band.dx >= 0.0 ? row.from : row.to;
        const double along = static_cast<double>(nearest) * band.dx + static_cast<double>(z) * band.dz;
        if (!planes.touched || along < planes.first_along) planes.first_along = along;
        planes.touched = true;
    }
}

}  // namespace trochoid
