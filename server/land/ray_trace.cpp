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

/// Depths at which something becomes of a ray's waves.
struct RayDepths {
    const DepthResponse& response;
    /// Shoaling starts below `felt`, and is armed again from `forgotten` on; metres.
    double felt;
    double forgotten;
};

/// What the depths of a whole tile of the terrain (16 x 16 cells) leave out, found when a ray first comes there.
class GroundTiles {
public:
    /// Neither land nor breakers; nowhere so shallow that shoaling starts; nowhere so deep that it may start again.
    static constexpr uint8_t open = 1;
    static constexpr uint8_t never_felt = 2;
    static constexpr uint8_t never_forgotten = 4;

    GroundTiles(const TerrainGrid& terrain, const RayDepths& depths, double run_up)
        : terrain_(terrain),
          depths_(depths),
          run_up_(run_up),
          across_(((terrain.columns - 2) >> tile_log2) + 1),
          down_(((terrain.rows - 2) >> tile_log2) + 1),
          tiles_(size_t{across_} * down_, 0) {}

    /// 0 outside the terrain.
    uint8_t at(LatticePoint p) {
        const auto column =
            static_cast<uint64_t>(p.x - terrain_.origin_x) >> (terrain_.spacing_log2 + tile_log2);
        const auto row =
            static_cast<uint64_t>(p.z - terrain_.origin_z) >> (terrain_.spacing_log2 + tile_log2);
        if (column >= across_ || row >= down_) return 0;
        uint8_t& tile = tiles_[row * across_ + column];
        if (tile == 0) tile = look_at(column << tile_log2, row << tile_log2);
        return tile;
    }

private:
    static constexpr uint32_t tile_log2 = 4;
    static constexpr uint8_t known = 8;

    uint8_t look_at(uint64_t first_column, uint64_t first_row) const {
        const uint64_t last_column =
            std::min<uint64_t>(first_column + (1U << tile_log2), terrain_.columns - 1);
        const uint64_t last_row = std::min<uint64_t>(first_row + (1U << tile_log2), terrain_.rows - 1);
        // Heights between samples are rounded means of theirs.
        int16_t lowest = INT16_MAX;
        int16_t highest = INT16_MIN;
        for (uint64_t row = first_row; row <= last_row; ++row) {
            const int16_t* const heights = terrain_.heights.data() + row * terrain_.columns;
            for (uint64_t column = first_column; column <= last_column; ++column) {
                lowest = std::min(lowest, heights[column]);
                highest = std::max(highest, heights[column]);
            }
        }
        const double least = depth_of(highest);
        const double most = depth_of(lowest);
        uint8_t tile = known;
        if (depths_.response.all_passes_from(least)) tile |= open;
        if (least >= depths_.felt) tile |= never_felt;
        if (most < depths_.forgotten) tile |= never_forgotten;
        return tile;
    }
    double depth_of(int16_t count) const {
        return to_metres(-(int64_t{count} * (int64_t{1} << terrain_.height_step_log2))) + run_up_;
    }

    const TerrainGrid& terrain_;
    const RayDepths& depths_;
    double run_up_;
    uint32_t across_;
    uint32_t down_;
    std::vector<uint8_t> tiles_;
};

/// What a ray remembers on its way.
class RayState {
public:
    RayState(const RayDepths& depths, double recovered_per_step)
        : depths_(depths), recovered_per_step_(recovered_per_step) {}

    void pass(LatticePoint at, double depth, std::vector<ActionPoint>& points) {
        const bool land = depth <= 0.0;
        if (depth < depths_.felt && !felt_) {
            felt_ = true;
            points.push_back({at, ActionKind::shoaling_starts});
        } else if (depth >= depths_.forgotten) {
            felt_ = false;
        }
        if (land != on_land_) points.push_back({at, land ? ActionKind::blocked : ActionKind::water_again});
        on_land_ = land;
        share_ = std::min(std::min(share_ + recovered_per_step_, 1.0), depths_.response.share_limit(depth));
        if (land) recovering_ = true;
        if (recovering_ && share_ >= 1.0) {
            recovering_ = false;
            points.push_back({at, ActionKind::recovered});
        }
    }
    /// The same where nothing can begin or end but that the share climbs; false: it may.
    bool passes_quietly(uint8_t ground) {
        const uint8_t quiet =
            GroundTiles::open | (felt_ ? GroundTiles::never_forgotten : GroundTiles::never_felt);
        if (on_land_ || recovering_ || (ground & quiet) != quiet) return false;
        share_ = std::min(share_ + recovered_per_step_, 1.0);
        return true;
    }

private:
    const RayDepths& depths_;
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
    const RayDepths depths{response, felt_depth, 1.25 * felt_depth};
    GroundTiles ground(terrain, depths, settings.run_up);
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
        RayState state(depths, step / 1024.0 / settings.recovery);
        for (double u = walked.from; u <= walked.to; u += step) {
            const LatticePoint at = axes.at(u, v);
            if (state.passes_quietly(ground.at(at))) continue;
            const double depth = to_metres(-int64_t{height_at(terrain, at.x, at.z)}) + settings.run_up;
            state.pass(at, depth, ray.points);
        }
        rays.push_back(std::move(ray));
    }
    return rays;
}

}  // namespace trochoid
