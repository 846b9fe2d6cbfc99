#include "server/world/terrain_edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"
#include "server/event/wind_limits.hpp"

namespace trochoid {

namespace {

Error out_of_range(std::string message) { return {ErrorCode::value_out_of_range, std::move(message)}; }

/// A point in samples from the grid's first.
struct Place {
    double column = 0.0;
    double row = 0.0;
};

struct Segment {
    Place from;
    Place to;
};

/// Whole numbers within [from, to] and [0, count).
struct Run {
    int64_t first = 0;
    int64_t last = -1;
};

Run run_of(double from, double to, uint32_t count) {
    const double most = static_cast<double>(count) - 1.0;
    if (!(to >= 0.0 && from <= most)) return {};
    // Truncation rounds down where the value is not negative.
    const auto first = from <= 0.0 ? int64_t{0} : static_cast<int64_t>(from);
    const auto last = to >= most ? int64_t{count} - 1 : static_cast<int64_t>(to) + 1;
    return {first, std::min(last, int64_t{count} - 1)};
}

double distance(const Segment& s, Place p) {
    const double dx = s.to.column - s.from.column;
    const double dz = s.to.row - s.from.row;
    const double px = p.column - s.from.column;
    const double pz = p.row - s.from.row;
    const double squared = dx * dx + dz * dz;
    const double along = squared > 0.0 ? std::clamp((px * dx + pz * dz) / squared, 0.0, 1.0) : 0.0;
    const double ex = px - along * dx;
    const double ez = pz - along * dz;
    return std::sqrt(ex * ex + ez * ez);
}

/// What the change makes of heights; lengths in samples, heights in counts.
class Shape {
public:
    Shape(const TerrainGrid& grid, const ChangeLand& change) : dig_(change.dig) {
        const double sample = to_metres(int64_t{1} << grid.spacing_log2);
        const double count = to_metres(int64_t{1} << grid.height_step_log2);
        crest_ = static_cast<double>(change.crest) / count;
        half_width_ = std::max(static_cast<double>(change.width) / sample, least_crest_samples) / 2.0;
        counts_per_sample_ = sample / side_slope / count;
        const auto [lowest, highest] = std::minmax_element(grid.heights.begin(), grid.heights.end());
        const double extreme = static_cast<double>(dig_ ? *highest : *lowest);
        const double difference = dig_ ? extreme - crest_ : crest_ - extreme;
        reach_ = half_width_ + std::max(difference, 0.0) / counts_per_sample_;
    }

    /// Beyond it nothing changes.
    double reach() const { return reach_; }
    int16_t changed(int16_t height, double away) const {
        const double beside = std::max(away - half_width_, 0.0) * counts_per_sample_;
        const double target = dig_ ? crest_ + beside : crest_ - beside;
        const double held =
            std::clamp(target, static_cast<double>(INT16_MIN), static_cast<double>(INT16_MAX));
        const auto count = static_cast<int16_t>(held < 0.0 ? held - 0.5 : held + 0.5);
        return dig_ ? std::min(height, count) : std::max(height, count);
    }

private:
    bool dig_;
    double crest_ = 0.0;
    double half_width_ = 0.0;
    double counts_per_sample_ = 0.0;
    double reach_ = 0.0;
};

/// The samples that changed, inclusive.
struct Changed {
    size_t samples = 0;
    int64_t first_column = INT64_MAX, first_row = INT64_MAX;
    int64_t last_column = -1, last_row = -1;
};

/// The columns of a row that may lie within `reach` of the segment.
Run columns_near(const Segment& s, double row, double reach, uint32_t columns) {
    const double dz = s.to.row - s.from.row;
    double begin = 0.0;
    double end = 1.0;
    if (dz != 0.0) {
        const double a = (row - reach - s.from.row) / dz;
        const double b = (row + reach - s.from.row) / dz;
        begin = std::clamp(std::min(a, b), 0.0, 1.0);
        end = std::clamp(std::max(a, b), 0.0, 1.0);
    }
    const double dx = s.to.column - s.from.column;
    const double x0 = s.from.column + begin * dx;
    const double x1 = s.from.column + end * dx;
    return run_of(std::min(x0, x1) - reach, std::max(x0, x1) + reach, columns);
}

void change_along(TerrainGrid& grid, const Shape& shape, const Segment& s, Changed& changed) {
    const Run rows = run_of(std::min(s.from.row, s.to.row) - shape.reach(),
                            std::max(s.from.row, s.to.row) + shape.reach(), grid.rows);
    for (int64_t row = rows.first; row <= rows.last; ++row) {
        const Run columns = columns_near(s, static_cast<double>(row), shape.reach(), grid.columns);
        for (int64_t column = columns.first; column <= columns.last; ++column) {
            int16_t& height = grid.heights[static_cast<size_t>(row * int64_t{grid.columns} + column)];
            const int16_t now =
                shape.changed(height, distance(s, {static_cast<double>(column), static_cast<double>(row)}));
            if (now == height) continue;
            height = now;
            ++changed.samples;
            changed.first_column = std::min(changed.first_column, column);
            changed.last_column = std::max(changed.last_column, column);
            changed.first_row = std::min(changed.first_row, row);
            changed.last_row = std::max(changed.last_row, row);
        }
    }
}

/// Cells around the changed samples; a changed border sample acts as far as the belt reaches.
LatticeRect rect_of(const Changed& c, const TerrainGrid& grid) {
    constexpr int64_t belt = int64_t{1} << open_sea_belt_cells_log2;
    const int64_t west = c.first_column == 0 ? -belt : c.first_column - 1;
    const int64_t north = c.first_row == 0 ? -belt : c.first_row - 1;
    const int64_t east =
        c.last_column == int64_t{grid.columns} - 1 ? c.last_column + belt : c.last_column + 1;
    const int64_t south = c.last_row == int64_t{grid.rows} - 1 ? c.last_row + belt : c.last_row + 1;
    const int64_t sample = int64_t{1} << grid.spacing_log2;
    return {{grid.origin_x + west * sample, grid.origin_z + north * sample},
            {grid.origin_x + east * sample, grid.origin_z + south * sample}};
}

}  // namespace

// Each comparison is written so that NaN is refused too.
Result<Done> validate(const ChangeLand& change) {
    if (change.line.size() < fewest_line_points || change.line.size() > most_line_points)
        return out_of_range(fmt::format("the line has {} points: give {} to {}", change.line.size(),
                                        fewest_line_points, most_line_points));
    for (const LatticePoint& p : change.line)
        if (!inside_world(p))
            return out_of_range(fmt::format(
                "the line's point x {} z {} m lies outside the world: keep |x| and |z| within {} m",
                to_metres(p.x), to_metres(p.z), to_metres(world_bound)));
    if (!(change.width >= narrowest_crest && change.width <= widest_crest))
        return out_of_range(fmt::format("the crest is {} m wide: give {} to {}", change.width,
                                        narrowest_crest, widest_crest));
    if (!(change.crest >= -highest_crest && change.crest <= highest_crest))
        return out_of_range(fmt::format("the crest lies {} m above still water: give {} to {}", change.crest,
                                        -highest_crest, highest_crest));
    return Done{};
}

Result<TerrainEdit> edited(const TerrainGrid& terrain, const ChangeLand& change) {
    const Shape shape(terrain, change);
    auto grid = std::make_shared<TerrainGrid>(terrain);
    const double sample = static_cast<double>(int64_t{1} << terrain.spacing_log2);
    const auto place = [&](LatticePoint p) {
        return Place{static_cast<double>(p.x - terrain.origin_x) / sample,
                     static_cast<double>(p.z - terrain.origin_z) / sample};
    };
    Changed changed;
    for (size_t i = 0; i + 1 < change.line.size(); ++i)
        change_along(*grid, shape, {place(change.line[i]), place(change.line[i + 1])}, changed);
    if (changed.samples == 0)
        return out_of_range(
            fmt::format("nothing changes: the line lies beside the terrain, or the ground is {} already",
                        change.dig ? "as deep" : "as high"));
    const LatticeRect touched = rect_of(changed, *grid);
    return TerrainEdit{std::move(grid), touched, changed.samples};
}

TerrainEdit followed_by(const TerrainEdit& first, TerrainEdit next) {
    const LatticeRect& a = first.touched;
    const LatticeRect& b = next.touched;
    next.touched = {{std::min(a.min.x, b.min.x), std::min(a.min.z, b.min.z)},
                    {std::max(a.max.x, b.max.x), std::max(a.max.z, b.max.z)}};
    next.samples += first.samples;
    return next;
}

Result<TerrainEdit> edited(const TerrainGrid& terrain, std::span<const ChangeLand> changes) {
    TROCHOID_ASSERT(!changes.empty(), "no change of the land");
    Result<TerrainEdit> sum = edited(terrain, changes.front());
    for (const ChangeLand& change : changes.subspan(1)) {
        if (!sum) break;
        Result<TerrainEdit> next = edited(*sum->terrain, change);
        if (!next) return next;
        sum = followed_by(*sum, std::move(next).value());
    }
    return sum;
}

std::vector<ChangeLand> changes_of(const LandChanged& event) {
    std::vector<ChangeLand> changes{event.change};
    changes.insert(changes.end(), event.also.begin(), event.also.end());
    return changes;
}

}  // namespace trochoid
