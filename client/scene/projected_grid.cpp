#include "client/scene/projected_grid.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <optional>

#include "protocol/model/displayed.hpp"

namespace trochoid {

namespace {

/// 1 / (2 R), 1/m: still water falls below the plane at the camera by d * d * this.
constexpr double bend = 0.5 / earth_radius;
/// Shaders address places by 32 bits relative to the anchor.
constexpr double farthest_m = 400'000.0;
constexpr double least_row_spacing_m = 0.5 * static_cast<double>(finest_vertex_spacing);
constexpr double half_circle = 3.14159265358979;
/// Mean over waves of what of their slope is turned to a camera near the water.
constexpr double facing_slope = 0.15;
/// Samples of the row density along the line of sight.
constexpr size_t knots = 600;

/// What of the water is in view, seen from the side: a wedge between the picture's bottom and top, cut with the layer that waves
/// reach. Angles are radians below the horizontal.
struct SideView {
    double altitude;
    double pitch;
    double half_angle;
    double tan_x;
    double lowest;   // of the waves relative to the camera, m, curvature apart
    double highest;  // and the highest
    double reach;    // how far waves move water sideways, m
    double bottom() const { return half_angle - pitch; }
    double top() const { return -half_angle - pitch; }
};

/// Metres ahead between which water may be in view.
struct Stretch {
    double from;
    double to;
};

double cotangent(double angle) { return std::cos(angle) / std::sin(angle); }

double farthest_ahead(const SideView& s) {
    const double rise = std::max(s.highest + s.altitude, 0.0);
    const double horizon = std::sqrt(s.altitude / bend) + std::sqrt(rise / bend);
    double end = std::min(horizon, farthest_m);
    if (s.top() > 0.0) {
        // Where the ray along the picture's top meets the deepest trough, which is lower towards the sides.
        const double fall = bend * (1.0 + s.tan_x * s.tan_x);
        const double slope = std::tan(s.top());
        const double root = slope * slope + 4.0 * fall * s.lowest;
        if (root > 0.0) end = std::min(end, -2.0 * s.lowest / (slope + std::sqrt(root)));
    } else if (s.bottom() < 0.0) {
        end = std::min(end, std::max(s.highest, 0.0) * cotangent(-s.bottom()));
    }
    return end;
}

std::optional<Stretch> stretch_in_view(const SideView& s) {
    if (s.bottom() <= 0.0 && s.highest <= 0.0) return std::nullopt;
    double from = 0.0;
    if (s.bottom() > 0.0) {
        const double cot = cotangent(s.bottom());
        from = std::min(-s.lowest * cot, -std::min(s.highest, 0.0) * cot);
        if (s.highest > 0.0) from = std::min(from, 0.0);
    }
    // Past the zenith crests stand upside down in the picture.
    if (s.highest > 0.0 && s.top() < -0.5 * half_circle)
        from = std::min(from, s.highest * cotangent(-s.top()));
    const Stretch stretch{from - s.reach, farthest_ahead(s) + s.reach};
    if (stretch.to <= stretch.from) return std::nullopt;
    return stretch;
}

/// How far to either side water at rest `ahead` may come into view.
double half_width_at(const SideView& s, double ahead) {
    const double fall = bend * ahead * ahead * (1.0 + s.tan_x * s.tan_x);
    const double height = s.pitch < 0.0 ? s.lowest - fall : s.highest;
    const double depth = (ahead + s.reach) * std::cos(s.pitch) + height * std::sin(s.pitch);
    return s.tan_x * std::max(depth, 0.0) + s.reach;
}

/// Density of rows over the water.
struct RowDensity {
    SideView side;
    double seen_from;  // m: altitude, or more where waves rise about the camera
    double attention;
    double crest;       // m above still water of common waves
    double tan_bottom;  // of the water's part of the picture, tangents of angles below the line of sight
    double tan_top;
    double horizon;    // m
    double row_angle;  // some radians between rows

    RowDensity(const SideView& s, double amplitude, uint32_t rows, double wanted_attention)
        : side(s),
          // Near still water all would be foreshortened, the crests before the camera's eye too.
          seen_from(std::max({s.altitude, 0.25 * amplitude, 1.0})),
          attention(std::clamp(wanted_attention, 0.25, 4.0)),
          crest(0.25 * amplitude),
          horizon(std::sqrt(seen_from / bend)) {
        const double dip = std::atan(2.0 * bend * horizon);
        tan_bottom = std::tan(s.half_angle);
        tan_top = std::tan(std::clamp(dip + s.pitch, -s.half_angle, s.half_angle));
        row_angle = std::max((tan_bottom - tan_top) / rows, 1e-5);
    }

    /// Radians times metres that a metre of slopes turned to the camera shows, where crests are higher than a row.
    double of_slopes(double ahead) const {
        const double away = std::max(std::abs(ahead), 1.0);
        return facing_slope * away * crest / (crest + away * row_angle);
    }

    /// Share of the water's height in the picture that a metre at `ahead` takes, up to a factor.
    double of_picture(double ahead) const {
        const double below = seen_from + bend * ahead * ahead;
        const double still = std::max(std::abs(seen_from - bend * ahead * ahead), 0.02 * seen_from);
        const double turned = (still + of_slopes(ahead)) / (ahead * ahead + below * below);
        const double tangent =
            std::tan(std::clamp(std::atan2(below, ahead) + side.pitch, -side.half_angle, side.half_angle));
        const double height = tan_bottom - tan_top;
        const double share = height > 1e-6 ? (tangent - tan_top) / height : 1.0;
        return turned * (1.0 + tangent * tangent) * std::pow(std::clamp(share, 0.004, 1.0), attention - 1.0);
    }

    /// Rows a metre that the horizon takes at least, so that it is a line at its height.
    double of_horizon(double ahead) const {
        if (ahead < 0.3 * horizon) return 0.0;
        const double share = std::min((ahead / horizon - 0.3) / 0.3, 1.0);
        return share * (ahead < 1.1 * horizon ? 4.0 : 1.0) / ahead;
    }
};

/// Rows up to each knot, for a density that is `of_picture * scale` within its limits.
class RowCount {
public:
    RowCount(const Stretch& stretch, const RowDensity& density) {
        // Knots are dense below the camera and far apart in the distance, evenly so in asinh.
        const double unit = density.seen_from;
        const double first = std::asinh(stretch.from / unit);
        const double last = std::asinh(stretch.to / unit);
        for (size_t i = 0; i <= knots; ++i) {
            const double share = static_cast<double>(i) / knots;
            ahead_.push_back(unit * std::sinh(first + (last - first) * share));
            picture_.push_back(density.of_picture(ahead_.back()));
            horizon_.push_back(density.of_horizon(ahead_.back()));
        }
        rows_.resize(knots + 1, 0.0);
    }

    double count(double scale) {
        double before = density_at(0, scale);
        for (size_t i = 1; i <= knots; ++i) {
            const double here = density_at(i, scale);
            rows_[i] = rows_[i - 1] + 0.5 * (before + here) * (ahead_[i] - ahead_[i - 1]);
            before = here;
        }
        return rows_.back();
    }

    /// Metres ahead of the rows, `wanted` + 1 of them, with the scale of the last count().
    std::vector<double> places(uint32_t wanted) const {
        std::vector<double> places;
        size_t knot = 1;
        for (uint32_t row = 0; row <= wanted; ++row) {
            const double at = rows_.back() * row / wanted;
            while (knot < knots && rows_[knot] < at) ++knot;
            const double width = rows_[knot] - rows_[knot - 1];
            const double share = width > 0.0 ? std::clamp((at - rows_[knot - 1]) / width, 0.0, 1.0) : 1.0;
            places.push_back(ahead_[knot - 1] + share * (ahead_[knot] - ahead_[knot - 1]));
        }
        return places;
    }

private:
    double density_at(size_t knot, double scale) const {
        return std::max(std::min(picture_[knot] * scale, 1.0 / least_row_spacing_m), horizon_[knot]);
    }
    std::vector<double> ahead_;
    std::vector<double> picture_;
    std::vector<double> horizon_;
    std::vector<double> rows_;
};

/// Finds the scale that makes so many rows, or as many as the least spacing leaves room for.
uint32_t fit(RowCount& count, uint32_t wanted) {
    double low = -20.0;  // ln of the scale
    double high = 25.0;
    if (count.count(std::exp(high)) <= wanted)
        return std::max(1U, static_cast<uint32_t>(std::ceil(count.count(std::exp(high)))));
    for (int i = 0; i < 36; ++i) {
        const double middle = 0.5 * (low + high);
        (count.count(std::exp(middle)) > wanted ? high : low) = middle;
    }
    count.count(std::exp(low));
    return wanted;
}

}  // namespace

ProjectedView projected_view(const CameraFrame& frame) {
    const glm::mat4 rows = glm::transpose(frame.clip_from_camera);
    const glm::vec3 across(rows[0]);
    const glm::vec3 upright(rows[1]);
    const glm::vec2 right = glm::normalize(glm::vec2(across.x, across.z));
    return {std::max(static_cast<double>(frame.altitude), 0.01),
            std::asin(std::clamp(static_cast<double>(frame.forward.y), -1.0, 1.0)),
            1.0 / static_cast<double>(glm::length(across)),
            1.0 / static_cast<double>(glm::length(upright)),
            right,
            {right.y, -right.x}};
}

ProjectedShape projected_shape(const DrawOptions& options, const ProjectedView& view,
                               float angle_per_vertex) {
    const auto quads = [&](uint32_t asked, double tangent, double denser) {
        const double wanted =
            asked > 0 ? asked : std::round(2.0 * tangent * denser / static_cast<double>(angle_per_vertex));
        return static_cast<uint32_t>(std::clamp(wanted, 2.0, static_cast<double>(most_projected_quads)));
    };
    return {quads(options.projected_rows, view.tan_half_height, 6.0),
            quads(options.projected_columns, view.tan_half_width, 1.0)};
}

VertexSteps steps_at(const ProjectedView& view, const ProjectedGrid& grid, size_t row, uint32_t column) {
    const ProjectedRow& at = grid.rows[row];
    const float columns = static_cast<float>(grid.columns);
    const float side = static_cast<float>(2 * column) / columns - 1.0F;
    return {view.forward * at.along + view.right * (at.widening * side),
            view.right * (2.0F * at.half_width / columns)};
}

float wave_spacing(const VertexSteps& steps, glm::vec2 k, float wavelength, float least) {
    const glm::vec2 turned{glm::dot(k, steps.along), glm::dot(k, steps.across)};
    return std::max(wavelength * glm::length(turned) * 0.15915494F, least);
}

ProjectedGrid make_projected_grid(const ProjectedView& view, const WaveBounds& waves, ProjectedShape shape,
                                  double attention) {
    const auto height = static_cast<double>(waves.height);
    const SideView side{view.altitude_m,
                        std::clamp(view.pitch, -0.5 * half_circle, 0.5 * half_circle),
                        std::atan(view.tan_half_height),
                        view.tan_half_width,
                        -view.altitude_m - height,
                        height - view.altitude_m,
                        static_cast<double>(waves.displacement)};
    const std::optional<Stretch> stretch = stretch_in_view(side);
    if (!stretch) return {};
    RowCount count(*stretch, RowDensity(side, height, shape.rows, attention));
    const std::vector<double> places = count.places(fit(count, shape.rows));
    ProjectedGrid grid;
    double widest = 0.0;
    for (const double ahead : places) widest = std::max(widest, half_width_at(side, ahead));
    grid.columns = static_cast<uint32_t>(
        std::min(static_cast<double>(shape.columns), std::ceil(2.0 * widest / least_row_spacing_m)));
    for (size_t i = 0; i < places.size(); ++i) {
        const double before = i > 0 ? places[i] - places[i - 1] : 0.0;
        const double behind = i + 1 < places.size() ? places[i + 1] - places[i] : 0.0;
        const double half_width = half_width_at(side, places[i]);
        const double widening = before > behind ? half_width - half_width_at(side, places[i - 1])
                                                : half_width_at(side, places[i] + behind) - half_width;
        grid.rows.push_back({static_cast<float>(places[i]), static_cast<float>(half_width),
                             static_cast<float>(std::max(before, behind)), static_cast<float>(widening)});
    }
    return grid;
}

}  // namespace trochoid
