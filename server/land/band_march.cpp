#include "server/land/band_march.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/row_march.hpp"

namespace trochoid {

namespace {

constexpr double unshallowed = 1.0;

/// Smallest integer not below a value in [0, 2^31).
int32_t ceiling(double value) {
    const auto whole = static_cast<int32_t>(value);
    return static_cast<double>(whole) < value ? whole + 1 : whole;
}

double magnitude(double value) { return value < 0.0 ? -value : value; }

/// One binomial pass (1 2 1) / 4 along both axes; the outermost nodes repeat. Written as differences so that equal values
/// stay exactly equal.
void smooth_once(std::vector<float>& values, int32_t nx, int32_t nz) {
    const auto at = [nx](int32_t x, int32_t z) {
        return static_cast<size_t>(z) * static_cast<size_t>(nx) + static_cast<size_t>(x);
    };
    std::vector<float> before(static_cast<size_t>(nx));
    std::vector<float> here(static_cast<size_t>(nx));
    for (int32_t z = 0; z < nz; ++z) {
        float* const row = values.data() + at(0, z);
        float left = row[0];
        for (int32_t x = 0; x < nx; ++x) {
            const float mid = row[x];
            const float right = row[std::min(x + 1, nx - 1)];
            row[x] = mid + 0.25F * ((left - mid) + (right - mid));
            left = mid;
        }
    }
    std::copy_n(values.data(), nx, before.data());
    for (int32_t z = 0; z < nz; ++z) {
        float* const row = values.data() + at(0, z);
        const float* const after = values.data() + at(0, std::min(z + 1, nz - 1));
        std::copy_n(row, nx, here.data());
        for (int32_t x = 0; x < nx; ++x) {
            const auto i = static_cast<size_t>(x);
            row[x] = here[i] + 0.25F * ((before[i] - here[i]) + (after[x] - here[i]));
        }
        before.swap(here);
    }
}

/// Samples the bed along a row of the march and turns depth into wave numbers and limits of the share that passes.
class RowSampler {
public:
    RowSampler(const LandArea& area, std::span<const float> depths, const std::vector<float>& phase_depth,
               const DepthResponse& response, const BandGrid& grid, double open_wave_number, bool straight)
        : nx_(area.nodes_x()),
          nz_(area.nodes_z()),
          depths_(depths),
          phase_depths_(phase_depth),
          response_(response),
          grid_(grid),
          open_(open_wave_number),
          skip_land_(straight) {}

    void sample(int32_t row, MarchRow& wave_numbers, MarchRow& limits) const {
        const double along = static_cast<double>(row) * grid_.row_step - grid_.centre_row;
        const double x0 = grid_.centre_x + along * grid_.dx + grid_.centre_column * grid_.dz;
        const double z0 = grid_.centre_z + along * grid_.dz - grid_.centre_column * grid_.dx;
        for (int32_t j = 0; j < grid_.columns; ++j) {
            const auto to = static_cast<size_t>(j) + 1;
            const double x = x0 - static_cast<double>(j) * grid_.dz;
            const double z = z0 + static_cast<double>(j) * grid_.dx;
            wave_numbers[to] = open_;
            limits[to] = unshallowed;
            if (x < 0.0 || z < 0.0 || x >= static_cast<double>(nx_ - 1) || z >= static_cast<double>(nz_ - 1))
                continue;
            sample_point(x, z, wave_numbers[to], limits[to]);
        }
        wave_numbers.front() = wave_numbers[1];
        wave_numbers.back() = wave_numbers[wave_numbers.size() - 2];
    }

private:
    void sample_point(double x, double z, double& wave_number, double& limit) const {
        const auto ix = static_cast<int32_t>(x);
        const auto iz = static_cast<int32_t>(z);
        const double fx = x - static_cast<double>(ix);
        const double fz = z - static_cast<double>(iz);
        const size_t n = static_cast<size_t>(iz) * static_cast<size_t>(nx_) + static_cast<size_t>(ix);
        const double depth = between(depths_.data() + n, fx, fz);
        // The nearest node decides too, so that land one node wide has no holes.
        const size_t nearest = n + (fx >= 0.5 ? 1U : 0U) + (fz >= 0.5 ? static_cast<size_t>(nx_) : 0U);
        const bool land = depth <= 0.0 || depths_[nearest] <= 0.0F;
        const double phase_depth = between(phase_depths_.data() + n, fx, fz);
        if (phase_depth < response_.deep() && !(land && skip_land_))
            wave_number = open_ * response_.wave_number(phase_depth);
        if (land) {
            limit = 0.0;
        } else if (depth < response_.untouched()) {
            limit = std::min(response_.breaking_gain(depth) / response_.growth(depth), 1.0);
        }
    }

    double between(const float* n00, double fx, double fz) const {
        const auto north = static_cast<double>(n00[0]);
        const auto south = static_cast<double>(n00[nx_]);
        const double a = north + (static_cast<double>(n00[1]) - north) * fx;
        const double b = south + (static_cast<double>(n00[nx_ + 1]) - south) * fx;
        return a + (b - a) * fz;
    }

    int32_t nx_;
    int32_t nz_;
    std::span<const float> depths_;
    const std::vector<float>& phase_depths_;
    const DepthResponse& response_;
    const BandGrid& grid_;
    double open_;
    bool skip_land_;
};

/// The grid's frame around the area; nothing marched yet.
BandGrid frame_of(const LandArea& area, const WaveBand& band, const LandSettings& settings) {
    BandGrid grid;
    grid.dx = band.dx;
    grid.dz = band.dz;
    grid.centre_x = static_cast<double>(area.nodes_x() - 1) * 0.5;
    grid.centre_z = static_cast<double>(area.nodes_z() - 1) * 0.5;
    grid.row_step = 1.0 / static_cast<double>(settings.rows_per_node);
    grid.centre_row = magnitude(band.dx) * grid.centre_x + magnitude(band.dz) * grid.centre_z + 1.0;
    grid.centre_column = magnitude(band.dz) * grid.centre_x + magnitude(band.dx) * grid.centre_z + 1.0;
    grid.rows = ceiling(2.0 * grid.centre_row / grid.row_step) + 1;
    grid.columns = ceiling(2.0 * grid.centre_column) + 1;
    return grid;
}

/// The last row that nothing touches yet, or rows where nothing touches any.
int32_t first_touched_row(const LandArea& area, std::span<const float> depths,
                          const std::vector<float>& phase_depth, const DepthResponse& response,
                          const BandGrid& grid) {
    const auto untouched = static_cast<float>(response.untouched());
    const auto deep = static_cast<float>(response.deep());
    bool any = false;
    double nearest = 0.0;
    for (int32_t z = 0; z < area.nodes_z(); ++z) {
        for (int32_t x = 0; x < area.nodes_x(); ++x) {
            const size_t n =
                static_cast<size_t>(z) * static_cast<size_t>(area.nodes_x()) + static_cast<size_t>(x);
            if (depths[n] >= untouched && phase_depth[n] >= deep) continue;
            const double along = (static_cast<double>(x) - grid.centre_x) * grid.dx +
                                 (static_cast<double>(z) - grid.centre_z) * grid.dz;
            if (!any || along < nearest) nearest = along;
            any = true;
        }
    }
    if (!any) return grid.rows;
    // A node shows in the bilinear samples up to sqrt(2) nodes away.
    const double row = (nearest + grid.centre_row - 2.0) / grid.row_step;
    return row > 0.0 ? static_cast<int32_t>(row) : 0;
}

}  // namespace

BandGrid::Value BandGrid::at(double x, double z) const {
    const double along = (x - centre_x) * dx + (z - centre_z) * dz + centre_row;
    const double across = (z - centre_z) * dx - (x - centre_x) * dz + centre_column;
    const double i = along / row_step - static_cast<double>(first_row);
    if (i <= 0.0 || shift.empty()) return {0.0, 1.0};
    const double last_row = static_cast<double>(rows - first_row - 1);
    const double last_column = static_cast<double>(columns - 1);
    const double row = std::min(i, last_row);
    const double column = std::min(std::max(across, 0.0), last_column);
    const int32_t r = std::min(static_cast<int32_t>(row), rows - first_row - 2);
    const int32_t c = std::min(static_cast<int32_t>(column), columns - 2);
    const double fr = row - static_cast<double>(r);
    const double fc = column - static_cast<double>(c);
    const size_t n = static_cast<size_t>(r) * static_cast<size_t>(columns) + static_cast<size_t>(c);
    const auto below = static_cast<size_t>(columns);
    const auto between = [&](const std::vector<float>& values) {
        const auto near = static_cast<double>(values[n]);
        const auto far = static_cast<double>(values[n + below]);
        const double a = near + (static_cast<double>(values[n + 1]) - near) * fc;
        const double b = far + (static_cast<double>(values[n + below + 1]) - far) * fc;
        return a + (b - a) * fr;
    };
    return {between(shift), between(shelter)};
}

std::vector<float> phase_depths(const LandArea& area, std::span<const float> depths, const WaveBand& band,
                                const DepthResponse& response) {
    const auto shallowest = static_cast<float>(response.shallowest());
    const auto deep = static_cast<float>(response.deep());
    std::vector<float> smooth(depths.begin(), depths.end());
    for (float& depth : smooth) depth = std::min(std::max(depth, shallowest), deep);
    // A pass has variance 1/2 node^2 along each axis: enough of them for a standard deviation of an eighth of a wave length.
    const double deviation = 0.125 / (band.turns_per_metre * area.step());
    const int32_t passes = std::clamp(static_cast<int32_t>(std::min(2.0 * deviation * deviation, 8.0)), 1, 8);
    for (int32_t pass = 0; pass < passes; ++pass) smooth_once(smooth, area.nodes_x(), area.nodes_z());
    return smooth;
}

BandGrid march_band(const LandArea& area, std::span<const float> depths, const WaveBand& band,
                    const DepthResponse& response, const LandSettings& settings) {
    BandGrid grid = frame_of(area, band, settings);
    const std::vector<float> smooth = phase_depths(area, depths, band, response);
    grid.first_row = first_touched_row(area, depths, smooth, response, grid);
    if (grid.first_row >= grid.rows - 1) return grid;

    const double open = band.turns_per_metre * area.step();
    const auto columns = static_cast<size_t>(grid.columns);
    LandSettings band_settings = settings;
    if (open > settings.waves_per_node_max) band_settings.refraction = Refraction::none;
    PhaseMarch phase(band_settings, columns, open, grid.row_step);
    ShelterMarch shelter(settings, columns, area.step(), grid.row_step);
    const bool straight = settings.refraction == Refraction::straight;
    const RowSampler sampler(area, depths, smooth, response, grid, open, straight);

    const auto marched = static_cast<size_t>(grid.rows - grid.first_row);
    grid.shift.assign(marched * columns, 0.0F);
    grid.shelter.assign(marched * columns, 1.0F);
    MarchRow wave_numbers(columns + 2, open);
    MarchRow limits(columns + 2, 1.0);
    for (int32_t row = grid.first_row + 1; row < grid.rows; ++row) {
        sampler.sample(row, wave_numbers, limits);
        phase.advance(wave_numbers);
        shelter.advance(limits);
        const size_t to = static_cast<size_t>(row - grid.first_row) * columns;
        for (size_t j = 0; j < columns; ++j) {
            grid.shift[to + j] = static_cast<float>(phase.shift()[j + 1]);
            grid.shelter[to + j] = static_cast<float>(shelter.shelter()[j + 1]);
        }
    }
    grid.cut_slopes = phase.cut_slopes();
    return grid;
}

}  // namespace trochoid
