#include "server/land/node_field.hpp"

#include <algorithm>
#include <limits>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/plane_sampler.hpp"
#include "server/land/turning.hpp"
#include "server/land/wide_rows.hpp"

namespace trochoid {

namespace {

constexpr int32_t negligible_shift = 1 << 6;
constexpr int32_t negligible_gain = 1 << 4;
constexpr int32_t negligible_orbit = 1 << 3;

/// Nearest integer, halves away from zero, for |value| < 2^31.
inline int32_t nearest(float value) {
    const float half = value < 0.0F ? -0.5F : 0.5F;
    return static_cast<int32_t>(value + half);
}

/// A factor of at least 0 that is one in open water, with one = 2^15 or 2^14.
inline uint16_t node_factor(float factor, int32_t one, int32_t negligible) {
    const float raised = std::min(factor * static_cast<float>(one), 65535.0F) + 0.5F;
    const auto rounded = static_cast<int32_t>(raised);
    const int32_t off = rounded - one;
    const int32_t apart = off < 0 ? -off : off;
    return static_cast<uint16_t>(apart <= negligible ? one : rounded);
}

inline int32_t node_shift(float turns) {
    const int32_t rounded = nearest(turns * 65536.0F);
    const int32_t apart = rounded < 0 ? -rounded : rounded;
    return apart < negligible_shift ? 0 : rounded;
}

/// Metres beyond [least, most].
double beyond(double value, double least, double most) {
    return std::max(std::max(least - value, value - most), 0.0);
}

/// 1 on the terrain and its belt, falling smoothly to 0 over the run-out around them.
float presence(double metres_beyond, double run_out) {
    const double part = metres_beyond / run_out;
    if (part >= 1.0) return 0.0F;
    return static_cast<float>(1.0 - part * part * (3.0 - 2.0 * part));
}

TROCHOID_WIDE_ROWS void put_shifts(const float* __restrict turns, size_t count, int32_t* __restrict out) {
    for (size_t i = 0; i < count; ++i) out[i] = node_shift(turns[i]);
}

TROCHOID_WIDE_ROWS void put_gains(const float* __restrict factors, size_t count, uint16_t* __restrict out) {
    for (size_t i = 0; i < count; ++i) out[i] = node_factor(factors[i], unit_node_gain, negligible_gain);
}

TROCHOID_WIDE_ROWS void multiply(float* __restrict values, const float* __restrict by, size_t count) {
    for (size_t i = 0; i < count; ++i) values[i] = by[i] * values[i];
}

TROCHOID_WIDE_ROWS void take_smaller(float* __restrict values, const float* __restrict most, size_t count) {
    for (size_t i = 0; i < count; ++i) values[i] = most[i] < values[i] ? most[i] : values[i];
}

/// One row of nodes after the other, in passes of which most run in vector registers.
class RowFiller {
public:
    RowFiller(NodeField& field, const LandArea& area, std::span<const float> depths,
              std::span<const float> tile_depths, std::span<const uint8_t> wanted, const BandGrid& grid,
              const DepthTable& table, const LandSettings& settings)
        : field_(field),
          area_(area),
          depths_(depths),
          tile_depths_(tile_depths),
          wanted_(wanted),
          tiles_x_(static_cast<size_t>(area.nodes_x() - 1) / TileMarks::side + 1),
          grid_(grid),
          table_(table),
          run_out_(settings.run_out),
          shift_(static_cast<size_t>(area.nodes_x())),
          shelter_(shift_.size()),
          part_(shift_.size()),
          gain_(shift_.size()),
          most_(shift_.size()) {
        for (int32_t x = 0; x < area.nodes_x(); ++x) {
            const double metres =
                beyond(static_cast<double>(x) * area.step(), area.belt_min_x, area.belt_max_x);
            beyond_x_.push_back(metres);
            any_beyond_x_ = any_beyond_x_ || metres > 0.0;
        }
    }

    /// In order of z.
    void fill(int32_t z) {
        if (z % TileMarks::side == 0) find_runs(z);
        if (runs_.empty()) return;
        const int32_t nx = area_.nodes_x();
        const size_t start = static_cast<size_t>(z) * static_cast<size_t>(nx);
        const ObliqueRow points = points_of(z);
        IndexRange held{0, nx};
        held = indices_inside(held, points.z, points.dz, int64_t{grid_.rows - grid_.first_row - 1} << 32);
        held = indices_inside(held, points.x, points.dx, int64_t{grid_.columns - 1} << 32);
        const double beyond_z =
            beyond(static_cast<double>(z) * area_.step(), area_.belt_min_z, area_.belt_max_z);
        const bool fades = beyond_z > 0.0 || any_beyond_x_;
        for (const Run& run : runs_) {
            const IndexRange inside{std::clamp(held.from, run.nodes.from, run.nodes.to),
                                    std::clamp(held.to, run.nodes.from, run.nodes.to)};
            if (run.marks == 0 || inside.from >= inside.to) {
                open_water(start, run.nodes);
                continue;
            }
            open_water(start, {run.nodes.from, inside.from});
            open_water(start, {inside.to, run.nodes.to});
            resample(inside, points, run.marks);
            if (fades) fade(inside, beyond_z);
            look_up(start, inside, run.marks);
            if (!field_.orbit.empty()) put_orbits(start, inside, fades);
            put(start, inside);
        }
    }

private:
    /// Beside those of the grid: the tile has nodes that depth changes, and such where waves may break.
    static constexpr uint8_t grows = 4;
    static constexpr uint8_t breaks = 8;

    /// Neighbouring tiles with the same marks.
    struct Run {
        IndexRange nodes;
        uint8_t marks;
    };

    /// The row's nodes on the grid.
    ObliqueRow points_of(int32_t z) const {
        return {to_q32(grid_.column_of(0.0, static_cast<double>(z))),
                to_q32(grid_.row_of(0.0, static_cast<double>(z)) - static_cast<double>(grid_.first_row)),
                to_q32(-grid_.dz), to_q32(grid_.dx / grid_.row_step)};
    }

    /// The wanted tiles of the row of tiles that begins with node row z.
    void find_runs(int32_t z) {
        runs_.clear();
        const ObliqueRow north = points_of(z);
        const ObliqueRow south = points_of(std::min(z + TileMarks::side, area_.nodes_z()) - 1);
        const auto tile_row = static_cast<size_t>(z >> TileMarks::side_log2) * tiles_x_;
        for (size_t tile = 0; tile < tiles_x_; ++tile) {
            if (wanted_[tile_row + tile] == 0) continue;
            const auto from = static_cast<int32_t>(tile) * TileMarks::side;
            const int32_t to = std::min(from + TileMarks::side, area_.nodes_x());
            const uint8_t marks = marks_of(tile_row + tile, {from, to}, north, south);
            if (!runs_.empty() && runs_.back().nodes.to == from && runs_.back().marks == marks)
                runs_.back().nodes.to = to;
            else
                runs_.push_back({{from, to}, marks});
        }
    }
    uint8_t marks_of(size_t tile, IndexRange nodes, const ObliqueRow& north, const ObliqueRow& south) const {
        const float depth = tile_depths_[tile];
        uint8_t marks = 0;
        if (depth < table_.untouched()) marks |= grows;
        if (depth < table_.breaking()) marks |= breaks;
        // Where rows are closer together than nodes, a tile's nodes reach farther than its marks.
        if (grid_.row_step < 1.0) return marks | BandGrid::shifts | BandGrid::shelters;
        // No node of the tile is farther from the nearest of its corners than the marks are spread.
        const auto add = [&](const ObliqueRow& points, int32_t x) {
            marks |= grid_.marks.at(std::clamp(points.x_of(x), 0, grid_.columns - 1),
                                    std::clamp(points.z_of(x), 0, grid_.rows - grid_.first_row - 1));
        };
        add(north, nodes.from);
        add(north, nodes.to - 1);
        add(south, nodes.from);
        add(south, nodes.to - 1);
        return marks;
    }

    /// Shift and shelter of nodes that the grid holds.
    void resample(IndexRange run, const ObliqueRow& points, uint8_t marks) {
        if ((marks & (BandGrid::shifts | BandGrid::shelters)) != 0)
            sampler_.place(points, run, static_cast<size_t>(grid_.columns));
        if ((marks & BandGrid::shifts) != 0)
            sampler_.sample(grid_.shift.data(), run, shift_.data());
        else
            std::fill(shift_.begin() + run.from, shift_.begin() + run.to, 0.0F);
        if ((marks & BandGrid::shelters) != 0)
            sampler_.sample(grid_.shelter.data(), run, shelter_.data());
        else
            std::fill(shelter_.begin() + run.from, shelter_.begin() + run.to, 1.0F);
    }

    void fade(IndexRange held, double beyond_z) {
        for (int32_t at = held.from; at < held.to; ++at) {
            const auto x = static_cast<size_t>(at);
            const double metres = std::max(beyond_x_[x], beyond_z);
            part_[x] = metres > 0.0 ? presence(metres, run_out_) : 1.0F;
            shift_[x] = shift_[x] * part_[x];
            shelter_[x] = 1.0F + (shelter_[x] - 1.0F) * part_[x];
        }
    }

    /// Gains: what arrives, grown, at most what breaking leaves.
    void look_up(size_t start, IndexRange run, uint8_t marks) {
        if ((marks & grows) == 0) {
            std::copy(shelter_.begin() + run.from, shelter_.begin() + run.to, gain_.begin() + run.from);
            return;
        }
        const auto from = static_cast<size_t>(run.from);
        const auto count = static_cast<size_t>(run.to - run.from);
        const float* const depths = depths_.data() + start + from;
        table_.growths(depths, count, gain_.data() + from);
        multiply(gain_.data() + from, shelter_.data() + from, count);
        if ((marks & breaks) == 0) return;
        table_.breaking_gains(depths, count, std::numeric_limits<float>::infinity(), most_.data() + from);
        take_smaller(gain_.data() + from, most_.data() + from, count);
    }

    void put(size_t start, IndexRange run) {
        const auto from = static_cast<size_t>(run.from);
        const auto count = static_cast<size_t>(run.to - run.from);
        put_shifts(shift_.data() + from, count, field_.shift.data() + start + from);
        put_gains(gain_.data() + from, count, field_.gain.data() + start + from);
    }

    void put_orbits(size_t start, IndexRange run, bool fades) {
        const float untouched = table_.untouched();
        for (int32_t at = run.from; at < run.to; ++at) {
            const auto x = static_cast<size_t>(at);
            const float depth = depths_[start + x];
            float orbit = 1.0F;
            if (depth < untouched) orbit = (depth > 0.0F ? table_.at(depth) : table_.land())[0];
            if (fades) orbit = 1.0F + (orbit - 1.0F) * part_[x];
            field_.orbit[start + x] = node_factor(orbit, unit_node_orbit, negligible_orbit);
        }
    }

    void open_water(size_t start, IndexRange range) {
        const auto from = static_cast<std::ptrdiff_t>(start) + range.from;
        const auto to = static_cast<std::ptrdiff_t>(start) + range.to;
        std::fill(field_.shift.begin() + from, field_.shift.begin() + to, 0);
        std::fill(field_.gain.begin() + from, field_.gain.begin() + to, unit_node_gain);
        if (!field_.orbit.empty())
            std::fill(field_.orbit.begin() + from, field_.orbit.begin() + to, unit_node_orbit);
    }

    NodeField& field_;
    const LandArea& area_;
    std::span<const float> depths_;
    std::span<const float> tile_depths_;
    std::span<const uint8_t> wanted_;
    size_t tiles_x_;
    const BandGrid& grid_;
    const DepthTable& table_;
    double run_out_;
    std::vector<double> beyond_x_;
    bool any_beyond_x_ = false;
    std::vector<float> shift_;
    std::vector<float> shelter_;
    std::vector<float> part_;
    std::vector<float> gain_;
    std::vector<float> most_;
    PlaneSampler sampler_;
    std::vector<Run> runs_;
};

}  // namespace

void fill_node_field(NodeField& field, const LandArea& area, std::span<const float> depths,
                     std::span<const float> tile_depths, std::span<const uint8_t> wanted,
                     const BandGrid& grid, const DepthTable& table, const LandSettings& settings,
                     const std::function<void(int32_t bz)>& filled) {
    field.shift.resize(area.nodes());
    field.gain.resize(area.nodes());
    field.orbit.resize(settings.shallow_orbits ? area.nodes() : 0);
    RowFiller filler(field, area, depths, tile_depths, wanted, grid, table, settings);
    for (int32_t z = 0; z < area.nodes_z(); ++z) {
        filler.fill(z);
        if (z > 0 && z % block_cells == 0) filled(z / block_cells - 1);
    }
}

size_t block_start(const LandArea& area, int32_t bx, int32_t bz) {
    return static_cast<size_t>(bz * block_cells) * static_cast<size_t>(area.nodes_x()) +
           static_cast<size_t>(bx * block_cells);
}

bool block_touches(const LandArea& area, int32_t bx, int32_t bz, const WaveTrainBox& box) {
    if ((box.length == 0 && box.width == 0) || !box.course.empty()) return true;
    const int64_t side = int64_t{block_cells} << area.step_log2;
    const LatticePoint corner = area.at(bx * block_cells, bz * block_cells);
    const BoxInstant still{.origin = box.origin};
    const BoxPosition centre = box_position(box, still, {corner.x + side / 2, corner.z + side / 2});
    if (!centre.in_reach) return true;
    // 3/4 of the side is above half its diagonal; 2 for the truncations.
    const int64_t radius = side * 3 / 4 + 2;
    if (box.length != 0 && (centre.u < -radius || centre.u > box.length + radius)) return false;
    return box.width == 0 || (centre.v >= -radius && centre.v <= box.width + radius);
}

bool block_is_open(const LandArea& area, const NodeField& field, int32_t bx, int32_t bz) {
    const auto nx = static_cast<size_t>(area.nodes_x());
    size_t n = block_start(area, bx, bz);
    for (int row = 0; row < block_nodes; ++row, n += nx) {
        int32_t differs = 0;
        for (size_t i = 0; i < block_nodes; ++i)
            differs |= field.shift[n + i] | (field.gain[n + i] ^ unit_node_gain);
        if (!field.orbit.empty())
            for (size_t i = 0; i < block_nodes; ++i) differs |= field.orbit[n + i] ^ unit_node_orbit;
        if (differs != 0) return false;
    }
    return true;
}

void copy_block(LandBlock& block, const LandArea& area, const NodeField& field, int32_t bx, int32_t bz,
                bool turned) {
    const auto nx = static_cast<size_t>(area.nodes_x());
    const size_t start = block_start(area, bx, bz);
    const auto copy = [&](const auto& from, auto& to) {
        if (turned) {
            turn_block(from.data() + start, nx, to.data());
            return;
        }
        for (size_t z = 0; z < block_nodes; ++z)
            std::copy_n(from.data() + start + z * nx, block_nodes, to.data() + z * block_nodes);
    };
    copy(field.shift, block.shift);
    copy(field.gain, block.gain);
    if (!field.orbit.empty()) copy(field.orbit, block.orbit);
}

TROCHOID_WIDE_ROWS uint16_t largest_gain(const LandBlock& block) {
    uint16_t most = 0;
    for (size_t n = 0; n < block_nodes * block_nodes; ++n) most = block.gain[n] > most ? block.gain[n] : most;
    return most;
}

}  // namespace trochoid
