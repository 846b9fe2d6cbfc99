#include "server/land/node_field.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/bilinear.hpp"

namespace trochoid {

namespace {

constexpr int32_t negligible_shift = 1 << 6;
constexpr int32_t negligible_gain = 1 << 4;
constexpr int32_t negligible_orbit = 1 << 3;

/// Nearest integer, halves away from zero, for |value| < 2^31.
inline int32_t nearest(float value) { return static_cast<int32_t>(value + (value < 0.0F ? -0.5F : 0.5F)); }

/// A factor of at least 0 that is one in open water, with one = 2^15 or 2^14.
inline uint16_t node_factor(float factor, int32_t one, int32_t negligible) {
    const float scaled = std::min(factor * static_cast<float>(one), 65535.0F);
    const auto rounded = static_cast<int32_t>(scaled + 0.5F);
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

/// One row of nodes after the other, in passes of which most run in vector registers.
class RowFiller {
public:
    RowFiller(NodeField& field, const LandArea& area, std::span<const float> depths, const BandGrid& grid,
              const DepthTable& table, const LandSettings& settings)
        : field_(field),
          area_(area),
          depths_(depths),
          grid_(grid),
          table_(table),
          run_out_(settings.run_out),
          shift_(static_cast<size_t>(area.nodes_x())),
          shelter_(shift_.size()),
          part_(shift_.size()),
          growth_(shift_.size()),
          most_(shift_.size()),
          orbit_(shift_.size()) {
        for (int32_t x = 0; x < area.nodes_x(); ++x) {
            const double metres =
                beyond(static_cast<double>(x) * area.step(), area.belt_min_x, area.belt_max_x);
            beyond_x_.push_back(metres);
            any_beyond_x_ = any_beyond_x_ || metres > 0.0;
        }
    }

    void fill(int32_t z) {
        const int32_t nx = area_.nodes_x();
        const size_t start = static_cast<size_t>(z) * static_cast<size_t>(nx);
        const IndexRange held = resample(z);
        open_water(start, {0, held.from});
        open_water(start, {held.to, nx});
        const double beyond_z =
            beyond(static_cast<double>(z) * area_.step(), area_.belt_min_z, area_.belt_max_z);
        const bool fades = beyond_z > 0.0 || any_beyond_x_;
        if (fades) fade(held, beyond_z);
        look_up(start, held);
        if (!field_.orbit.empty()) put_orbits(start, held, fades);
        put(start, held);
    }

private:
    /// Shift and shelter of the nodes that the grid holds.
    IndexRange resample(int32_t z) {
        const int64_t row_step = to_q32(grid_.dx / grid_.row_step);
        const int64_t column_step = to_q32(-grid_.dz);
        int64_t row =
            to_q32(grid_.row_of(0.0, static_cast<double>(z)) - static_cast<double>(grid_.first_row));
        int64_t column = to_q32(grid_.column_of(0.0, static_cast<double>(z)));
        const int64_t rows = int64_t{grid_.rows - grid_.first_row - 1} << 32;
        IndexRange held{0, area_.nodes_x()};
        held = indices_inside(held, row, row_step, rows);
        held = indices_inside(held, column, column_step, int64_t{grid_.columns - 1} << 32);
        row += held.from * row_step;
        column += held.from * column_step;
        const auto columns = static_cast<size_t>(grid_.columns);
        const float* const values = grid_.values.data();
        float* const shift = shift_.data();
        float* const shelter = shelter_.data();
        for (int32_t x = held.from; x < held.to; ++x, row += row_step, column += column_step) {
            const float* const near =
                values + 2 * (static_cast<size_t>(row >> 32) * columns + static_cast<size_t>(column >> 32));
            const ValuePair here = bilinear(near, near + 2 * columns, fraction_of(column), fraction_of(row));
            shift[x] = here.first;
            shelter[x] = here.second;
        }
        return held;
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

    void look_up(size_t start, IndexRange held) {
        const float untouched = table_.untouched();
        for (int32_t at = held.from; at < held.to; ++at) {
            const auto x = static_cast<size_t>(at);
            const float depth = depths_[start + x];
            FourFloats response{1.0F, 1.0F, 2.0F, 1.0F};
            if (depth < untouched) response = depth > 0.0F ? table_.at(depth) : table_.land();
            orbit_[x] = response[0];
            growth_[x] = response[1];
            most_[x] = response[2];
        }
    }

    void put(size_t start, IndexRange held) {
        const auto count = static_cast<size_t>(held.to - held.from);
        const size_t from = static_cast<size_t>(held.from);
        const float* const shift = shift_.data() + from;
        const float* const shelter = shelter_.data() + from;
        const float* const growth = growth_.data() + from;
        const float* const most = most_.data() + from;
        int32_t* const to_shift = field_.shift.data() + start + from;
        uint16_t* const to_gain = field_.gain.data() + start + from;
        for (size_t i = 0; i < count; ++i) to_shift[i] = node_shift(shift[i]);
        for (size_t i = 0; i < count; ++i)
            to_gain[i] =
                node_factor(std::min(shelter[i] * growth[i], most[i]), unit_node_gain, negligible_gain);
    }

    void put_orbits(size_t start, IndexRange held, bool fades) {
        for (int32_t at = held.from; at < held.to; ++at) {
            const auto x = static_cast<size_t>(at);
            const float orbit = fades ? 1.0F + (orbit_[x] - 1.0F) * part_[x] : orbit_[x];
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
    const BandGrid& grid_;
    const DepthTable& table_;
    double run_out_;
    std::vector<double> beyond_x_;
    bool any_beyond_x_ = false;
    std::vector<float> shift_;
    std::vector<float> shelter_;
    std::vector<float> part_;
    std::vector<float> growth_;
    std::vector<float> most_;
    std::vector<float> orbit_;
};

}  // namespace

void fill_node_field(NodeField& field, const LandArea& area, std::span<const float> depths,
                     const BandGrid& grid, const DepthTable& table, const LandSettings& settings) {
    field.shift.resize(area.nodes());
    field.gain.resize(area.nodes());
    field.orbit.resize(settings.shallow_orbits ? area.nodes() : 0);
    RowFiller filler(field, area, depths, grid, table, settings);
    for (int32_t z = 0; z < area.nodes_z(); ++z) filler.fill(z);
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

void copy_block(LandBlock& block, const LandArea& area, const NodeField& field, int32_t bx, int32_t bz) {
    block.key = {area.first.x + bx, area.first.z + bz};
    const auto nx = static_cast<std::ptrdiff_t>(area.nodes_x());
    auto from = static_cast<std::ptrdiff_t>(block_start(area, bx, bz));
    for (std::ptrdiff_t to = 0; to < block_nodes * block_nodes; to += block_nodes, from += nx) {
        std::copy_n(field.shift.begin() + from, block_nodes, block.shift.begin() + to);
        std::copy_n(field.gain.begin() + from, block_nodes, block.gain.begin() + to);
        if (!field.orbit.empty())
            std::copy_n(field.orbit.begin() + from, block_nodes, block.orbit.begin() + to);
    }
}

}  // namespace trochoid
