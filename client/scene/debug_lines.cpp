#include "client/scene/debug_lines.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace trochoid {

namespace {

constexpr Tint box_tint{255, 214, 64, 255};
constexpr Tint ramp_tint{255, 214, 64, 110};
constexpr Tint course_tint{255, 150, 40, 255};
constexpr Tint wake_tint{120, 235, 255, 200};
constexpr Tint ship_tint{255, 255, 255, 255};
constexpr Tint ray_tint{210, 235, 255, 90};
/// Long lines are cut so that they follow the sea's curvature.
constexpr double longest_piece_m = 1'000.0;
constexpr int most_pieces = 200;

class Drawing {
public:
    Drawing(DebugLines& out, const CameraFrame& frame) : out_(out), frame_(frame) {}

    void line(LatticePoint a, LatticePoint b, float height, Tint tint) {
        const double length = std::hypot(to_metres(b.x - a.x), to_metres(b.z - a.z));
        const int pieces = std::clamp(static_cast<int>(length / longest_piece_m) + 1, 1, most_pieces);
        for (int i = 0; i < pieces; ++i) {
            out_.lines.push_back(vertex(between(a, b, i, pieces), height, tint));
            out_.lines.push_back(vertex(between(a, b, i + 1, pieces), height, tint));
        }
    }

    void point(LatticePoint p, float height, Tint tint) { out_.points.push_back(vertex(p, height, tint)); }

    void square(LatticePoint corner, int64_t side, float height, Tint tint) {
        const LatticePoint ne{corner.x + side, corner.z};
        const LatticePoint sw{corner.x, corner.z + side};
        const LatticePoint se{corner.x + side, corner.z + side};
        for (const LatticePoint p : {corner, sw, se, corner, se, ne})
            out_.triangles.push_back(vertex(p, height, tint));
    }

private:
    static LatticePoint between(LatticePoint a, LatticePoint b, int i, int pieces) {
        return {a.x + (b.x - a.x) * i / pieces, a.z + (b.z - a.z) * i / pieces};
    }
    LineVertex vertex(LatticePoint p, float height, Tint tint) const {
        const glm::vec2 place = metres_from_anchor(frame_, p);
        return {place.x, height, place.y, tint};
    }
    DebugLines& out_;
    const CameraFrame& frame_;
};

constexpr float outline_height = 3.0F;

/// A box where it is at the moment.
struct PlacedBox {
    const WaveTrainBox& box;
    BoxInstant instant;

    /// World place of the box's own coordinates.
    LatticePoint at(int64_t u, int64_t v) const {
        return {instant.origin.x + ((u * box.ux - v * box.uz) >> 30),
                instant.origin.z + ((u * box.uz + v * box.ux) >> 30)};
    }
};

void add_rectangle(Drawing& drawing, const PlacedBox& b, int64_t u0, int64_t u1, int64_t v0, int64_t v1,
                   Tint tint) {
    drawing.line(b.at(u0, v0), b.at(u1, v0), outline_height, tint);
    drawing.line(b.at(u1, v0), b.at(u1, v1), outline_height, tint);
    drawing.line(b.at(u1, v1), b.at(u0, v1), outline_height, tint);
    drawing.line(b.at(u0, v1), b.at(u0, v0), outline_height, tint);
}

/// Where a moving box's middle (a ship: its place) was and will be within an hour, leg by leg, with a point at every turn.
void add_course(Drawing& drawing, const PlacedBox& b, SeaTime now) {
    constexpr int64_t shown_us = int64_t{3600} * microseconds_per_second;
    const bool ship = is_ship(b.box);
    const LatticePoint here = b.at(ship ? b.box.length : b.box.length / 2, b.box.width / 2);
    const auto middle = [&](LatticePoint corner) {
        return LatticePoint{here.x - b.instant.origin.x + corner.x, here.z - b.instant.origin.z + corner.z};
    };
    for (size_t i = 0; i < b.box.course.size(); ++i) {
        const CourseLeg& leg = b.box.course[i];
        SeaTime end = std::min(leg.from + leg.duration_us, now + shown_us);
        if (i + 1 < b.box.course.size()) end = std::min(end, b.box.course[i + 1].from);
        // A ship sails no farther than its box's end.
        if (ship) end = std::min(end, b.box.end);
        const SeaTime from = std::max(leg.from, now - shown_us);
        if (from >= end) continue;
        const std::span<const CourseLeg> so_far(b.box.course.data(), i + 1);
        drawing.line(middle(corner_at(so_far, from)), middle(corner_at(so_far, end)), outline_height,
                     course_tint);
        if (from == leg.from) drawing.point(middle(leg.origin), outline_height, course_tint);
    }
}

/// A ship as a hull in outline at its place, and the rectangle around its wake's wedge.
void add_ship(Drawing& drawing, const PlacedBox& b) {
    const int64_t u = has_wake(b.box.wake) ? b.box.length : b.box.length / 2;
    const int64_t v = b.box.width / 2;
    const bool told = has_hull(b.box.hull);
    const int64_t half_length = to_lattice(told ? 0.5 * static_cast<double>(b.box.hull.length) : 50.0);
    const int64_t half_beam = to_lattice(told ? 0.5 * static_cast<double>(b.box.hull.beam) : 9.0);
    const LatticePoint bow = b.at(u + half_length, v);
    for (const int64_t side : {-half_beam, half_beam}) {
        drawing.line(b.at(u - half_length, v + side), b.at(u + half_length / 2, v + side), outline_height,
                     ship_tint);
        drawing.line(b.at(u + half_length / 2, v + side), bow, outline_height, ship_tint);
    }
    drawing.line(b.at(u - half_length, v - half_beam), b.at(u - half_length, v + half_beam), outline_height,
                 ship_tint);
    if (!has_wake(b.box.wake)) return;
    const int64_t rear = std::min(b.instant.wake_rear, b.box.length);
    const int64_t front = std::min(b.instant.wake_front, rear);
    const int64_t aside = std::min(rear * 3 / 8, v);
    add_rectangle(drawing, b, u - rear, u - front, v - aside, v + aside, wake_tint);
    // The cusp lines at arctan(1/sqrt 8) = 19.47 degrees.
    for (const int64_t sign : {-1, 1})
        drawing.line(b.at(u, v), b.at(u - rear, v + sign * rear * 35355 / 100'000), outline_height,
                     wake_tint);
}

/// The box, the part of it inside its ramps, and an arrow along its travel; its course, its ship. Unlimited boxes have no
/// outline.
void add_box(Drawing& drawing, const WaveTrainBox& box, SeaTime now) {
    if (box.length == 0 || box.width == 0) return;
    const PlacedBox b{box, instant_of(box, now)};
    if (!box.course.empty()) add_course(drawing, b, now);
    add_rectangle(drawing, b, 0, box.length, 0, box.width, box_tint);
    if (is_ship(box)) {
        add_ship(drawing, b);
        return;
    }
    const int64_t u1 = box.length - box.ramp_front;
    const int64_t v1 = box.width - box.ramp_side;
    if (u1 > box.ramp_rear && v1 > box.ramp_side)
        add_rectangle(drawing, b, box.ramp_rear, u1, box.ramp_side, v1, ramp_tint);
    const LatticePoint tip = b.at(box.length * 5 / 8, box.width / 2);
    drawing.line(b.at(box.length * 3 / 8, box.width / 2), tip, outline_height, box_tint);
    drawing.line(b.at(box.length * 9 / 16, box.width * 7 / 16), tip, outline_height, box_tint);
    drawing.line(b.at(box.length * 9 / 16, box.width * 9 / 16), tip, outline_height, box_tint);
}

void add_patch(Drawing& drawing, PatchKey key) {
    const LatticePoint nw = corner_of(key);
    const int64_t side = side_of(key);
    const Tint tint = tint_of_level(key.level);
    // North and west only: the others are the neighbours' own.
    drawing.line(nw, {nw.x + side, nw.z}, 1.0F, tint);
    drawing.line(nw, {nw.x, nw.z + side}, 1.0F, tint);
}

void add_ray(Drawing& drawing, const WaveRay& ray) {
    drawing.line(ray.start, ray.end, 2.0F, ray_tint);
    for (const ActionPoint& point : ray.points) drawing.point(point.at, 2.0F, tint_of(point.kind));
}

/// Gain of a block's cells: red calm, clear untouched, blue higher than in open water.
void add_block(Drawing& drawing, const FieldBlock& field) {
    const LandBlock& block = *field.block;
    const int64_t step = int64_t{1} << field.step_log2;
    for (int z = 0; z < block_cells; ++z)
        for (int x = 0; x < block_cells; ++x) {
            const double gain = block.gain[static_cast<size_t>(z * block_nodes + x)] / 32768.0;
            const double away = std::min(std::abs(gain - 1.0), 1.0);
            const auto opacity = static_cast<uint8_t>(150.0 * away);
            if (opacity < 4) continue;
            const Tint tint = gain < 1.0 ? Tint{235, 60, 40, opacity} : Tint{60, 90, 255, opacity};
            drawing.square({(int64_t{block.key.x} * block_cells + x) * step,
                            (int64_t{block.key.z} * block_cells + z) * step},
                           step, 0.5F, tint);
        }
}

/// Fields of one box overlap: the first one stands for all.
void add_fields(Drawing& drawing, const InterestState& state) {
    if (state.blocks.empty()) return;
    const FieldId first = state.blocks.begin()->first.field;
    for (const auto& [key, block] : state.blocks)
        if (key.field == first) add_block(drawing, block);
}

}  // namespace

Tint tint_of(ActionKind kind) {
    switch (kind) {
        case ActionKind::shoaling_starts: return {90, 200, 255, 255};
        case ActionKind::blocked: return {255, 70, 50, 255};
        case ActionKind::water_again: return {255, 190, 60, 255};
        case ActionKind::recovered: return {110, 255, 120, 255};
    }
    return {255, 255, 255, 255};
}

Tint tint_of_level(uint8_t patch_level) {
    constexpr std::array<Tint, 6> tints{Tint{255, 90, 90, 220},  Tint{255, 190, 70, 220},
                                        Tint{230, 240, 90, 220}, Tint{110, 235, 120, 220},
                                        Tint{90, 210, 255, 220}, Tint{200, 140, 255, 220}};
    return tints[patch_level % tints.size()];
}

DebugLines make_debug_lines(const SceneInput& input, const InterestState& state, const CameraFrame& frame,
                            const SeaMesh& mesh, const DrawOptions& options) {
    DebugLines out;
    Drawing drawing(out, frame);
    if (options.fields) add_fields(drawing, state);
    if (options.patches)
        for (const PatchKey key : mesh.drawn) add_patch(drawing, key);
    if (options.boxes)
        for (const auto& [id, box] : state.boxes) add_box(drawing, *box, input.now);
    if (options.rays)
        for (const WaveRay& ray : input.rays) add_ray(drawing, ray);
    return out;
}

}  // namespace trochoid
