#include "server/land/band_march.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/bilinear.hpp"
#include "server/land/row_march.hpp"

namespace trochoid {

namespace {

/// Smallest integer not below a value in [0, 2^31).
int32_t ceiling(double value) {
    const auto whole = static_cast<int32_t>(value);
    return static_cast<double>(whole) < value ? whole + 1 : whole;
}

double magnitude(double value) { return value < 0.0 ? -value : value; }

/// Takes wave numbers and limits of the share that passes from the nodes to a row of the march.
class RowSampler {
public:
    RowSampler(const LandArea& area, const NodePlanes& planes, const BandGrid& grid, float open)
        : nx_(area.nodes_x()), nz_(area.nodes_z()), pairs_(planes.pairs.data()), grid_(grid), open_(open) {}

    void sample(int32_t row, MarchRow& wave_numbers, MarchRow& limits) const {
        const double along = static_cast<double>(row) * grid_.row_step - grid_.centre_row;
        const int64_t dx = to_q32(-grid_.dz);
        const int64_t dz = to_q32(grid_.dx);
        int64_t x = to_q32(grid_.centre_x + along * grid_.dx + grid_.centre_column * grid_.dz);
        int64_t z = to_q32(grid_.centre_z + along * grid_.dz - grid_.centre_column * grid_.dx);
        IndexRange inside{0, grid_.columns};
        inside = indices_inside(inside, x, dx, int64_t{nx_ - 1} << 32);
        inside = indices_inside(inside, z, dz, int64_t{nz_ - 1} << 32);
        fill(wave_numbers, limits, {0, inside.from});
        fill(wave_numbers, limits, {inside.to, grid_.columns});
        x += inside.from * dx;
        z += inside.from * dz;
        float* const k = wave_numbers.data() + 1;
        float* const limit = limits.data() + 1;
        for (int32_t j = inside.from; j < inside.to; ++j, x += dx, z += dz) {
            const auto ix = static_cast<size_t>(x >> 32);
            const size_t n = static_cast<size_t>(z >> 32) * static_cast<size_t>(nx_) + ix;
            const float fx = fraction_of(x);
            const float fz = fraction_of(z);
            const float* const north = pairs_ + 2 * n;
            const float* const south = north + 2 * static_cast<size_t>(nx_);
            prefetch(south + 2 * static_cast<size_t>(nx_));
            const ValuePair here = bilinear(north, south, fx, fz);
            // The nearest node decides too, so that land one node wide has no holes.
            const float nearest = (fz >= 0.5F ? south : north)[fx >= 0.5F ? 3 : 1];
            k[j] = here.first;
            limit[j] = nearest == 0.0F ? 0.0F : here.second;
        }
        wave_numbers.front() = wave_numbers[1];
        wave_numbers.back() = wave_numbers[wave_numbers.size() - 2];
    }

private:
    void fill(MarchRow& wave_numbers, MarchRow& limits, IndexRange range) const {
        std::fill(wave_numbers.begin() + range.from + 1, wave_numbers.begin() + range.to + 1, open_);
        std::fill(limits.begin() + range.from + 1, limits.begin() + range.to + 1, 1.0F);
    }

    int32_t nx_;
    int32_t nz_;
    const float* pairs_;
    const BandGrid& grid_;
    float open_;
};

void put_row(BandGrid& grid, int32_t row, const MarchRow& shift, const MarchRow& shelter) {
    float* const to = grid.values.data() +
                      2 * static_cast<size_t>(row - grid.first_row) * static_cast<size_t>(grid.columns);
    const auto columns = static_cast<size_t>(grid.columns);
    for (size_t j = 0; j < columns; ++j) {
        to[2 * j] = shift[j + 1];
        to[2 * j + 1] = shelter[j + 1];
    }
}

/// The last row that nothing touches yet, or rows where nothing touches any.
int32_t first_touched_row(const BandGrid& grid, const NodePlanes& planes) {
    if (!planes.touched) return grid.rows;
    const double nearest = planes.first_along - (grid.centre_x * grid.dx + grid.centre_z * grid.dz);
    // A node shows in the bilinear samples up to sqrt(2) nodes away, and in its neighbours' phase depths.
    const double row = (nearest + grid.centre_row - 2.0) / grid.row_step;
    return row > 0.0 ? static_cast<int32_t>(row) : 0;
}

struct Extent {
    double least;
    double most;
};

/// What of [-half, half] the corners' projections reach with the margin around.
Extent limited(Extent whole, const LandArea& area, const BandGrid& grid, double dx, double dz) {
    Extent corners{whole.most, whole.least};
    for (size_t i = 0; i < area.corners.size(); i += 2) {
        const double at = (area.corners[i] - grid.centre_x) * dx + (area.corners[i + 1] - grid.centre_z) * dz;
        corners = {std::min(corners.least, at), std::max(corners.most, at)};
    }
    const double least = std::max(whole.least, corners.least - LandArea::corner_margin);
    const double most = std::min(whole.most, corners.most + LandArea::corner_margin);
    return {least, std::max(least + 1.0, most)};
}

}  // namespace

void set_frame(BandGrid& grid, const LandArea& area, const WaveBand& band, const LandSettings& settings) {
    grid.dx = band.dx;
    grid.dz = band.dz;
    grid.centre_x = static_cast<double>(area.nodes_x() - 1) * 0.5;
    grid.centre_z = static_cast<double>(area.nodes_z() - 1) * 0.5;
    grid.row_step = 1.0 / static_cast<double>(settings.rows_per_node);
    const double half_along = magnitude(band.dx) * grid.centre_x + magnitude(band.dz) * grid.centre_z + 1.0;
    const double half_across = magnitude(band.dz) * grid.centre_x + magnitude(band.dx) * grid.centre_z + 1.0;
    Extent along{-half_along, half_along};
    Extent across{-half_across, half_across};
    if (area.cornered) {
        along = limited(along, area, grid, band.dx, band.dz);
        across = limited(across, area, grid, -band.dz, band.dx);
    }
    grid.centre_row = -along.least;
    grid.centre_column = -across.least;
    grid.rows = ceiling((along.most - along.least) / grid.row_step) + 1;
    grid.columns = ceiling(across.most - across.least) + 1;
    grid.first_row = 0;
    grid.values.clear();
    grid.cut_slopes = 0;
    grid.rows_marched = 0;
}

void march_band(BandGrid& grid, const LandArea& area, const NodePlanes& planes, const WaveBand& band,
                const DepthResponse& response, const LandSettings& settings,
                std::vector<MarchCheckpoint>& checkpoints) {
    const double open = band.turns_per_metre * area.step();
    const auto columns = static_cast<size_t>(grid.columns);
    LandSettings band_settings = settings;
    if (open > settings.waves_per_node_max) band_settings.refraction = Refraction::none;
    PhaseMarch phase(band_settings, columns, open, open * response.wave_number(response.shallowest()),
                     grid.row_step);
    ShelterMarch shelter(settings, columns, area.step(), open, grid.row_step);
    grid.first_row = checkpoints.empty() ? first_touched_row(grid, planes) : checkpoints.back().row;
    if (grid.first_row >= grid.rows - 1) return;
    if (!checkpoints.empty()) shelter.load(phase.load(checkpoints.back().state.data()));
    const RowSampler sampler(area, planes, grid, static_cast<float>(open));

    grid.values.resize(2 * static_cast<size_t>(grid.rows - grid.first_row) * columns);
    put_row(grid, grid.first_row, phase.shift(), shelter.shelter());
    MarchRow wave_numbers(columns + 2, static_cast<float>(open));
    MarchRow limits(columns + 2, 1.0F);
    for (int32_t row = grid.first_row + 1; row < grid.rows; ++row) {
        sampler.sample(row, wave_numbers, limits);
        phase.advance(wave_numbers);
        shelter.advance(limits);
        put_row(grid, row, phase.shift(), shelter.shelter());
        if (row % checkpoint_rows == 0) {
            checkpoints.push_back({row, {}});
            phase.save(checkpoints.back().state);
            shelter.save(checkpoints.back().state);
        }
    }
    grid.rows_marched = static_cast<uint64_t>(grid.rows - grid.first_row - 1);
    grid.cut_slopes = phase.cut_slopes();
}

}  // namespace trochoid
