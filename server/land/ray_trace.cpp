#include "server/land/ray_trace.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/depth_response.hpp"
#include "server/land/land_area.hpp"

namespace trochoid {

namespace {

constexpr double most_steps = 8192.0;

/// A part of a straight line, lattice units from its zero.
struct Span {
    double from;
    double to;
    bool empty() const { return from > to; }
};

/// The box's axes in float64: exact to a lattice unit over the world's bounds.
struct Axes {
    double x, z, ux, uz;

    Axes(const WaveTrainBox& box, LatticePoint origin)
        : x(static_cast<double>(origin.x)),
          z(static_cast<double>(origin.z)),
          ux(static_cast<double>(box.ux) * 0x1p-30),
          uz(static_cast<double>(box.uz) * 0x1p-30) {}

    LatticePoint at(double u, double v) const {
        return {nearest(x + u * ux - v * uz), nearest(z + u * uz + v * ux)};
    }
    static int64_t nearest(double value) {
        return static_cast<int64_t>(value < 0.0 ? value - 0.5 : value + 0.5);
    }
};

/// Cuts the span to where start + t * slope lies in [least, most].
Span clipped(Span span, double start, double slope, double least, double most) {
    if (slope == 0.0) return start < least || start > most ? Span{1.0, 0.0} : span;
    const double a = (least - start) / slope;
    const double b = (most - start) / slope;
    return {std::max(span.from, std::min(a, b)), std::min(span.to, std::max(a, b))};
}

Span within(const LatticeRect& r, const Axes& axes, double v, Span span) {
    span = clipped(span, axes.x - v * axes.uz, axes.ux, static_cast<double>(r.min.x),
                   static_cast<double>(r.max.x));
    return clipped(span, axes.z + v * axes.ux, axes.uz, static_cast<double>(r.min.z),
                   static_cast<double>(r.max.z));
}

/// Extent of the box across, or of the rectangle where the box is unlimited.
Span across(const WaveTrainBox& box, const LatticeRect& r, const Axes& axes) {
    if (box.width != 0) return {0.0, static_cast<double>(box.width)};
    Span span{0x1p62, -0x1p62};
    for (const int64_t x : {r.min.x, r.max.x}) {
        for (const int64_t z : {r.min.z, r.max.z}) {
            const double v =
                (static_cast<double>(z) - axes.z) * axes.ux - (static_cast<double>(x) - axes.x) * axes.uz;
            span = {std::min(span.from, v), std::max(span.to, v)};
        }
    }
    return span;
}

/// What a ray remembers on its way.
class RayState {
public:
    RayState(const DepthResponse& response, double felt_depth, double recovered_per_step)
        : response_(response), felt_depth_(felt_depth), recovered_per_step_(recovered_per_step) {}

    void pass(LatticePoint at, double depth, std::vector<ActionPoint>& points) {
        const bool land = depth <= 0.0;
        if (depth < felt_depth_ && !felt_) {
            felt_ = true;
            points.push_back({at, ActionKind::shoaling_starts});
        } else if (depth >= 1.25 * felt_depth_) {
            felt_ = false;
        }
        if (land != on_land_) points.push_back({at, land ? ActionKind::blocked : ActionKind::water_again});
        on_land_ = land;
        share_ = std::min(std::min(share_ + recovered_per_step_, 1.0), response_.share_limit(depth));
        if (land) recovering_ = true;
        if (recovering_ && share_ >= 1.0) {
            recovering_ = false;
            points.push_back({at, ActionKind::recovered});
        }
    }

private:
    const DepthResponse& response_;
    double felt_depth_;
    double recovered_per_step_;
    double share_ = 1.0;
    bool felt_ = false;
    bool on_land_ = false;
    bool recovering_ = false;
};

}  // namespace

std::vector<WaveRay> wave_rays(const WaveTrainBox& box, const TerrainGrid& terrain, const WaveBand& band,
                               const LandSettings& settings, RayReuse* reuse) {
    const Axes axes(box, box.course.empty() ? box.origin : corner_at(box.course, box.begin));
    const LatticeRect belt = belt_bounds(terrain);
    const double open_depth = to_metres(-int64_t{terrain.open_sea_depth}) + settings.run_up;
    const DepthResponse response(band.turns_per_metre, open_depth, significant_height(box), settings);
    const double felt_depth = std::min(0.5 / band.turns_per_metre, response.deep());
    const double half_node = static_cast<double>(int64_t{1} << settings.step_log2) * 0.5;

    const Span sides = across(box, belt, axes);
    const double per_node = (sides.to - sides.from) / (2.0 * half_node);
    const int count = per_node < wave_rays_max ? std::max(static_cast<int>(per_node), 1) : wave_rays_max;
    std::vector<WaveRay> rays;
    for (int i = 0; i < count; ++i) {
        const double v = sides.from + (sides.to - sides.from) * (2.0 * i + 1.0) / (2.0 * count);
        const Span whole =
            box.length != 0 ? Span{0.0, static_cast<double>(box.length)} : Span{-0x1p40, 0x1p40};
        const Span walked = within(belt, axes, v, whole);
        if (walked.empty() && box.length == 0) continue;
        const Span shown = box.length != 0 ? whole : walked;
        WaveRay ray{axes.at(shown.from, v), axes.at(shown.to, v), {}};
        if (reuse != nullptr && rays.size() < reuse->rays.size()) {
            const WaveRay& old = reuse->rays[rays.size()];
            if (old.start == ray.start && old.end == ray.end &&
                within(reuse->changed, axes, v, whole).empty()) {
                rays.push_back(old);
                continue;
            }
        }
        if (reuse != nullptr) ++reuse->walked;
        const double step = std::max(half_node, (walked.to - walked.from) / most_steps);
        RayState state(response, felt_depth, step / 1024.0 / settings.recovery);
        for (double u = walked.from; u <= walked.to; u += step) {
            const LatticePoint at = axes.at(u, v);
            const double depth = to_metres(-int64_t{height_at(terrain, at.x, at.z)}) + settings.run_up;
            state.pass(at, depth, ray.points);
        }
        rays.push_back(std::move(ray));
    }
    return rays;
}

}  // namespace trochoid
