#include "server/land/band_march.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/bilinear.hpp"
#include "server/land/plane_sampler.hpp"
#include "server/land/row_march.hpp"
#include "server/land/wide_rows.hpp"

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
        : nx_(area.nodes_x()), nz_(area.nodes_z()), planes_(planes), grid_(grid), open_(open) {}

    void sample(int32_t row, MarchRow& wave_numbers, MarchRow& limits) {
        const double along = static_cast<double>(row) * grid_.row_step - grid_.centre_row;
        ObliqueRow points;
        points.dx = to_q32(-grid_.dz);
        points.dz = to_q32(grid_.dx);
        points.x = to_q32(grid_.centre_x + along * grid_.dx + grid_.centre_column * grid_.dz);
        points.z = to_q32(grid_.centre_z + along * grid_.dz - grid_.centre_column * grid_.dx);
        IndexRange inside{0, grid_.columns};
        inside = indices_inside(inside, points.x, points.dx, int64_t{nx_ - 1} << 32);
        inside = indices_inside(inside, points.z, points.dz, int64_t{nz_ - 1} << 32);
        float* const k = wave_numbers.data() + 1;
        float* const limit = limits.data() + 1;
        std::fill(k, k + inside.from, open_);
        std::fill(limit, limit + inside.from, 1.0F);
        for_marked_runs(planes_.marks, points, inside, [&](IndexRange run, uint8_t marks) {
            if (marks != 0) sampler_.place(points, run, static_cast<size_t>(nx_));
            if ((marks & NodePlanes::bends) != 0)
                sampler_.sample(planes_.wave_numbers.data(), run, k);
            else
                std::fill(k + run.from, k + run.to, open_);
            if ((marks & NodePlanes::breaks) != 0)
                sampler_.sample_solid(planes_.limits.data(), run, limit);
            else
                std::fill(limit + run.from, limit + run.to, 1.0F);
        });
        std::fill(k + inside.to, k + grid_.columns, open_);
        std::fill(limit + inside.to, limit + grid_.columns, 1.0F);
        wave_numbers.front() = wave_numbers[1];
        wave_numbers.back() = wave_numbers[wave_numbers.size() - 2];
    }

private:
    int32_t nx_;
    int32_t nz_;
    const NodePlanes& planes_;
    const BandGrid& grid_;
    float open_;
    PlaneSampler sampler_;
};

/// Keeps the rows of a march as they go by: copies them out, hashes tiles (one hash a column, all columns alike, so that they run in
/// vector registers) and marks those that are not open water.
class RowKeeper {
public:
    explicit RowKeeper(BandGrid& grid)
        : grid_(grid),
          hashes_(tiles_across(grid) * TileMarks::side),
          shifted_(hashes_.size()),
          sheltered_(hashes_.size()) {
        const size_t tiles = static_cast<size_t>((grid.rows - 1) / TileMarks::side + 1) * tiles_across(grid);
        begin_hashes();
        begin_marks();
        if (grid.tile_hashes.size() != tiles || grid.first_row % TileMarks::side != 0) {
            // Rows that are not marched are open water.
            for (int32_t row = 0; row < TileMarks::side; ++row) add_open();
            end_hashes(0);
            grid.tile_hashes.resize(tiles);
            for (size_t tile = tiles_across(grid); tile < tiles; ++tile)
                grid.tile_hashes[tile] = grid.tile_hashes[tile % tiles_across(grid)];
            for (int32_t row = 0; row < grid.first_row % TileMarks::side; ++row) add_open();
            begin_marks();
        }
    }

    void put(int32_t row, const MarchRow& shift, const MarchRow& shelter) {
        const int32_t at = row - grid_.first_row;
        const auto columns = static_cast<size_t>(grid_.columns);
        const size_t start = static_cast<size_t>(at) * columns;
        const Kept kept{grid_.shift.data() + start, grid_.shelter.data() + start, hashes_.data(),
                        shifted_.data(), sheltered_.data()};
        keep(kept, shift.data() + 1, shelter.data() + 1, columns);
        const bool last = row == grid_.rows - 1;
        if (row % TileMarks::side == TileMarks::side - 1 || last) end_hashes(row / TileMarks::side);
        if (at % TileMarks::side == TileMarks::side - 1 || last) end_marks(at);
    }

private:
    static constexpr uint64_t factor = 0x9e3779b97f4a7c15U;

    /// Where a row goes; the last two take the bits in which a column differed from open water.
    struct Kept {
        float* shift;
        float* shelter;
        uint64_t* hashes;
        uint32_t* shifted;
        uint32_t* sheltered;
    };
    TROCHOID_WIDE_ROWS static void keep(const Kept& to, const float* __restrict shift,
                                        const float* __restrict shelter, size_t count) {
        float* __restrict const kept_shift = to.shift;
        float* __restrict const kept_shelter = to.shelter;
        uint64_t* __restrict const hashes = to.hashes;
        uint32_t* __restrict const shifted = to.shifted;
        uint32_t* __restrict const sheltered = to.sheltered;
        for (size_t j = 0; j < count; ++j) {
            const auto shift_bits = std::bit_cast<uint32_t>(shift[j]);
            const auto shelter_bits = std::bit_cast<uint32_t>(shelter[j]);
            kept_shift[j] = shift[j];
            kept_shelter[j] = shelter[j];
            shifted[j] |= shift_bits;
            sheltered[j] |= shelter_bits ^ std::bit_cast<uint32_t>(1.0F);
            uint64_t hash = (hashes[j] ^ (uint64_t{shift_bits} << 32 | uint64_t{shelter_bits})) * factor;
            hash ^= hash >> 29;
            hashes[j] = hash;
        }
    }
    void add_open() {
        const auto columns = static_cast<size_t>(grid_.columns);
        const std::vector<float> shift(columns, 0.0F);
        const std::vector<float> shelter(columns, 1.0F);
        std::vector<float> nowhere(2 * columns);
        keep({nowhere.data(), nowhere.data() + columns, hashes_.data(), shifted_.data(), sheltered_.data()},
             shift.data(), shelter.data(), columns);
    }
    void begin_hashes() { std::fill(hashes_.begin(), hashes_.end(), uint64_t{1}); }
    void begin_marks() {
        std::fill(shifted_.begin(), shifted_.end(), 0U);
        std::fill(sheltered_.begin(), sheltered_.end(), 0U);
    }
    void end_hashes(int32_t tile_row) {
        const size_t across = tiles_across(grid_);
        const size_t first = static_cast<size_t>(tile_row) * across;
        grid_.tile_hashes.resize(std::max(grid_.tile_hashes.size(), first + across));
        for (size_t tile = 0; tile < across; ++tile) {
            uint64_t hash = 0;
            for (size_t j = 0; j < TileMarks::side; ++j) {
                hash = (hash ^ hashes_[tile * TileMarks::side + j]) * factor;
                hash ^= hash >> 32;
            }
            grid_.tile_hashes[first + tile] = hash;
        }
        begin_hashes();
    }
    /// `row`: the last of the tiles', from the first row held on.
    void end_marks(int32_t row) {
        for (int32_t column = 0; column < grid_.columns; column += TileMarks::side) {
            uint32_t shifted = 0;
            uint32_t sheltered = 0;
            for (size_t j = 0; j < TileMarks::side; ++j) {
                shifted |= shifted_[static_cast<size_t>(column) + j];
                sheltered |= sheltered_[static_cast<size_t>(column) + j];
            }
            if (shifted != 0) grid_.marks.add(column, row, BandGrid::shifts);
            if (sheltered != 0) grid_.marks.add(column, row, BandGrid::shelters);
        }
        begin_marks();
    }

    BandGrid& grid_;
    std::vector<uint64_t> hashes_;
    std::vector<uint32_t> shifted_;
    std::vector<uint32_t> sheltered_;
};

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
    grid.held = false;
    grid.tile_hashes.clear();
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
    RowSampler sampler(area, planes, grid, static_cast<float>(open));

    // Every row is put below: what an earlier band left there need not be cleared.
    grid.held = true;
    grid.shift.resize(static_cast<size_t>(grid.rows - grid.first_row) * columns);
    grid.shelter.resize(grid.shift.size());
    grid.marks.reset(grid.columns, grid.rows - grid.first_row);
    RowKeeper keeper(grid);
    keeper.put(grid.first_row, phase.shift(), shelter.shelter());
    MarchRow wave_numbers(columns + 2, static_cast<float>(open));
    MarchRow limits(columns + 2, 1.0F);
    for (int32_t row = grid.first_row + 1; row < grid.rows; ++row) {
        sampler.sample(row, wave_numbers, limits);
        phase.advance(wave_numbers);
        shelter.advance(limits);
        keeper.put(row, phase.shift(), shelter.shelter());
        if (row % checkpoint_rows == 0) {
            checkpoints.push_back({row, {}});
            phase.save(checkpoints.back().state);
            shelter.save(checkpoints.back().state);
        }
    }
    grid.marks.spread(BandGrid::shifts | BandGrid::shelters);
    grid.rows_marched = static_cast<uint64_t>(grid.rows - grid.first_row - 1);
    grid.cut_slopes = phase.cut_slopes();
}

}  // namespace trochoid
