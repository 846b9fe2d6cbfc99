// Paper D's mesh on the GPU against the slow, obvious recursion on the CPU: the same triangles to the last number, whatever was
// before, and no cracks in any frame.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "client/gpu/coherent_mesh.hpp"
#include "client/gpu/frame_uniforms.hpp"
#include "client/gpu/offscreen_context.hpp"
#include "client/gpu/render_target.hpp"
#include "client/gpu/renderer.hpp"
#include "protocol/model/displayed.hpp"
#include "protocol/model/sea.hpp"
#include "tests/gpu/fixture_sea.hpp"
#include "tests/gpu/sea_probe.hpp"

namespace trochoid {
namespace {

using Triangles = std::vector<CoherentTriangle>;

constexpr int32_t half_side = int32_t{coherent_cells / 2} << coherent_cell_log2;

Triangles sorted(Triangles triangles) {
    std::sort(triangles.begin(), triangles.end(),
              [](const auto& a, const auto& b) { return a.identity < b.identity; });
    return triangles;
}

/// Patterns that led to a triangle, the last one first.
std::vector<int> patterns_of(const CoherentTriangle& t) {
    std::vector<int> patterns;
    uint64_t path = t.path;
    for (uint64_t i = t.identity; !is_root(i); i = identity_of_parent(i), path = path_of_parent(path))
        patterns.push_back(last_pattern(path));
    EXPECT_EQ(path, 0U);
    return patterns;
}

struct EdgeEnds {
    glm::ivec2 a, b;
};
bool before(const EdgeEnds& p, const EdgeEnds& q) {
    return std::tie(p.a.x, p.a.y, p.b.x, p.b.y) < std::tie(q.a.x, q.a.y, q.b.x, q.b.y);
}

bool on_outline(const EdgeEnds& e) {
    return (e.a.x == e.b.x && std::abs(e.a.x) == half_side) ||
           (e.a.y == e.b.y && std::abs(e.a.y) == half_side);
}

/// Edges that not exactly two triangles share (one on the outline), each once in either direction; and what the areas lack.
struct Faults {
    size_t edges = 0;
    int64_t area = 0;  // of twice the whole
    size_t flat = 0;   // triangles that face down or have no area
    bool operator==(const Faults&) const = default;
};
Faults faults_of(const Triangles& triangles) {
    Faults faults;
    std::vector<EdgeEnds> edges;
    for (const CoherentTriangle& t : triangles) {
        const glm::i64vec2 p(t.corners[1] - t.corners[0]);
        const glm::i64vec2 q(t.corners[2] - t.corners[0]);
        const int64_t area = p.y * q.x - p.x * q.y;
        faults.area += area;
        if (area <= 0) ++faults.flat;
        for (size_t k = 0; k < 3; ++k) {
            EdgeEnds e{t.corners[k], t.corners[(k + 1) % 3]};
            if (before({e.b, e.a}, e)) std::swap(e.a, e.b);
            edges.push_back(e);
        }
    }
    faults.area -= int64_t{8} * half_side * half_side;
    std::sort(edges.begin(), edges.end(), before);
    for (size_t i = 0; i < edges.size();) {
        size_t next = i;
        while (next < edges.size() && !before(edges[i], edges[next])) ++next;
        if (next - i != (on_outline(edges[i]) ? 1U : 2U)) ++faults.edges;
        i = next;
    }
    return faults;
}

Camera camera_at(double x, double z, double altitude, double yaw = 0, double pitch = -0.1) {
    Camera camera;
    move(camera, x, 0, z);
    camera.altitude_m = altitude;
    camera.yaw = yaw;
    camera.pitch = pitch;
    return camera;
}

/// A mesh with its eye.
class Viewer {
public:
    Viewer() = default;
    explicit Viewer(DisplayFilter filter, Refinement refinement = Refinement::distance)
        : filter_(filter), refinement_(refinement) {}

    CoherentWork look_from(const Camera& camera, uint32_t most_triangles = 2'000'000) {
        const CameraFrame frame = frame_of(camera, DepthRange::classic);
        eye_ = mesh_eye(frame, filter_, refinement_, planes_of(frame, DepthRange::classic), 3.0F);
        anchor_ = frame.anchor;
        FrameUniforms u;
        u.mesh_cell = {eye_.cell, 0, 0};
        u.mesh_eye = {eye_.fraction, eye_.altitude, 0.0F};
        u.mesh_filter = {eye_.filter.finest_spacing, eye_.filter.angle_per_vertex, 0.0F, 0.0F};
        u.choice.z = static_cast<int>(eye_.refinement);
        u.mesh_sides = eye_.sides;
        uniforms_.fill(GL_UNIFORM_BUFFER, std::span<const FrameUniforms>(&u, 1), GL_STREAM_DRAW);
        glBindBufferBase(GL_UNIFORM_BUFFER, frame_binding, uniforms_.name());
        return mesh.update(anchor_, eye_, most_triangles);
    }

    /// What the eye wants, from the base.
    Triangles wanted() const {
        const LatticePoint o = mesh.origin();
        const glm::ivec2 origin(static_cast<int>(o.x - anchor_.x), static_cast<int>(o.z - anchor_.z));
        return refined(base_triangles(mesh.window()), [&](glm::ivec2 a, glm::ivec2 b) {
            return edge_wants_split(eye_, origin + a, origin + b, mesh.coarser());
        });
    }

    void expect_right() const {
        const Triangles held = sorted(mesh.read());
        const Triangles expected = sorted(wanted());
        ASSERT_EQ(held.size(), expected.size());
        EXPECT_TRUE(held == expected);
        EXPECT_EQ(std::adjacent_find(held.begin(), held.end(),
                                     [](const auto& a, const auto& b) { return a.identity == b.identity; }),
                  held.end());
        EXPECT_EQ(faults_of(held), Faults{});
    }

    CoherentMesh mesh;

private:
    DisplayFilter filter_{1.0F, 0.04F};
    Refinement refinement_ = Refinement::distance;
    MeshEye eye_{};
    LatticePoint anchor_;
    GlBuffer uniforms_;
};

class Coherent : public testing::Test {
protected:
    static void SetUpTestSuite() {
        context_ = std::make_unique<OffscreenContext>();
        // Nothing is drawn, yet OpenGL wants a complete framebuffer.
        target_ = std::make_unique<RenderTarget>(16, 16, 1);
        target_->bind();
    }
    static void TearDownTestSuite() {
        target_.reset();
        context_.reset();
    }
    static std::unique_ptr<OffscreenContext> context_;
    static std::unique_ptr<RenderTarget> target_;
};
std::unique_ptr<OffscreenContext> Coherent::context_;
std::unique_ptr<RenderTarget> Coherent::target_;

TEST(CoherentTree, numbers_lead_back_through_every_pattern_for_22_levels) {
    for (int pattern = 1; pattern <= 7; ++pattern) {
        uint64_t identity = 255;
        uint64_t path = 0;
        for (int level = 0; level < coherent_most_levels; ++level) {
            const int child = level % coherent_children(pattern);
            const uint64_t i = identity_of_child(identity, child);
            const uint64_t p = path_of_child(path, pattern);
            EXPECT_GT(p, path) << "overflow";
            EXPECT_EQ(child_of(i), child);
            EXPECT_EQ(identity_of_parent(i), identity);
            EXPECT_EQ(last_pattern(p), pattern);
            EXPECT_EQ(path_of_parent(p), path);
            identity = i;
            path = p;
            EXPECT_EQ(coherent_level(identity), level + 1);
        }
    }
}

/// The triangle, its edges split as the pattern says and no others, cut into triangles that face the same way.
TEST(CoherentTree, patterns_split_the_edges_they_name_and_no_other) {
    const CoherentTriangle t{{glm::ivec2(64, 0), glm::ivec2(0, 0), glm::ivec2(32, 32)}, 5, 0};
    for (int mask = 1; mask < 8; ++mask) {
        const int pattern = coherent_pattern((mask & 1) != 0, (mask & 2) != 0, (mask & 4) != 0);
        const Triangles parts = divided(t, pattern);
        EXPECT_EQ(parts.size(), static_cast<size_t>(coherent_children(pattern)));
        int64_t area = 0;
        std::set<std::pair<int, int>> corners;
        for (const CoherentTriangle& part : parts) {
            const glm::ivec2 p = part.corners[1] - part.corners[0];
            const glm::ivec2 q = part.corners[2] - part.corners[0];
            EXPECT_GT(p.y * q.x - p.x * q.y, 0);
            area += p.y * q.x - p.x * q.y;
            for (const glm::ivec2 c : part.corners) corners.emplace(c.x, c.y);
        }
        EXPECT_EQ(area, 64 * 32);
        for (int edge = 0; edge < 3; ++edge) {
            const glm::ivec2 middle =
                (t.corners[static_cast<size_t>(edge)] + t.corners[static_cast<size_t>((edge + 1) % 3)]) / 2;
            EXPECT_EQ(corners.contains({middle.x, middle.y}), (mask & (1 << edge)) != 0) << pattern;
        }
    }
}

TEST(CoherentTree, the_base_is_256_triangles_without_gaps_and_keeps_its_numbers) {
    const Triangles base = base_triangles({5, -3});
    EXPECT_EQ(base.size(), coherent_roots);
    EXPECT_EQ(faults_of(base), Faults{});
    // The window moves by a cell: what stays has the same numbers, what comes has those of what goes.
    const Triangles added = base_triangles({6, -3}, {5, -3});
    EXPECT_EQ(added.size(), size_t{coherent_cells} * 4);
    Triangles moved;
    for (CoherentTriangle t : base) {
        for (glm::ivec2& c : t.corners) c.x -= 1 << coherent_cell_log2;
        if (std::min({t.corners[0].x, t.corners[1].x, t.corners[2].x}) >= -half_side) moved.push_back(t);
    }
    moved.insert(moved.end(), added.begin(), added.end());
    EXPECT_TRUE(sorted(moved) == sorted(base_triangles({6, -3})));
}

TEST_F(Coherent, first_frame_is_what_the_recursion_makes) {
    for (const Refinement refinement : {Refinement::distance, Refinement::screen, Refinement::frustum}) {
        Viewer viewer({0.5F, 0.04F}, refinement);
        const CoherentWork work = viewer.look_from(camera_at(1'234.5, -777.25, 7.5, 0.7));
        EXPECT_TRUE(work.from_base);
        fmt::print("{}: {} triangles in {} passes\n", name_of(refinement), work.triangles, work.passes);
        EXPECT_GT(work.triangles, 8'000U);
        viewer.expect_right();
    }
}

/// Fifty frames forwards, turning and climbing a little: equal to the recursion and whole in each.
TEST_F(Coherent, slow_flight_by_each_criterion) {
    for (const Refinement refinement : {Refinement::distance, Refinement::screen, Refinement::frustum}) {
        SCOPED_TRACE(name_of(refinement));
        Viewer viewer({1.0F, 0.045F}, refinement);
        uint32_t passes = 0;
        for (int frame = 0; frame < 50; ++frame) {
            const CoherentWork work = viewer.look_from(camera_at(
                9'876'543.0 + 1.7 * frame, -50.0 - 0.9 * frame, 12.0 + 0.1 * frame, 0.02 * frame, -0.15));
            if (frame > 0) {
                EXPECT_FALSE(work.from_base);
                passes += work.passes;
            }
            viewer.expect_right();
            if (HasFailure()) return;
        }
        fmt::print("{}: {:.2f} passes a frame of {} triangles\n", name_of(refinement), passes / 49.0,
                   viewer.mesh.triangles());
    }
}

TEST_F(Coherent, jumps_turns_and_back_again) {
    for (const Refinement refinement : {Refinement::distance, Refinement::screen, Refinement::frustum}) {
        SCOPED_TRACE(name_of(refinement));
        Viewer viewer({0.5F, 0.03F}, refinement);
        for (const Camera& camera :
             {camera_at(0, 0, 2), camera_at(0, 0, 2, 3.1), camera_at(3, 1, 900, 0, -1.5),
              camera_at(5'000, 100, 2), camera_at(5'000, 100, 40'000), camera_at(-6'000, 6'000, 30, 1, 0.2),
              camera_at(-6'000, 6'000, 30, 2, -1.5), camera_at(20'000'000, -9'000'000, 5),
              camera_at(0, 0, 2)}) {
            viewer.look_from(camera);
            viewer.expect_right();
            if (HasFailure()) return;
        }
    }
}

TEST_F(Coherent, coarsens_down_to_the_base_and_comes_back) {
    Viewer viewer;
    viewer.look_from(camera_at(100, 100, 3));
    const Triangles fine = sorted(viewer.mesh.read());
    const CoherentWork down = viewer.look_from(camera_at(100, 100, 9'000'000));
    EXPECT_EQ(down.triangles, 256U);
    EXPECT_EQ(down.passes, 1U);
    EXPECT_TRUE(sorted(viewer.mesh.read()) == sorted(base_triangles(viewer.mesh.window())));
    viewer.look_from(camera_at(100, 100, 3));
    EXPECT_TRUE(sorted(viewer.mesh.read()) == fine);
}

/// An eye that stays costs no pass; the same mesh from scratch is the same.
TEST_F(Coherent, keeps_what_it_has_and_equals_a_mesh_from_scratch) {
    Viewer viewer;
    for (int frame = 0; frame < 5; ++frame) viewer.look_from(camera_at(50.0 * frame, 3, 5 + frame));
    EXPECT_EQ(viewer.look_from(camera_at(200, 3, 9)).passes, 0U);
    Viewer fresh;
    EXPECT_TRUE(fresh.look_from(camera_at(200, 3, 9)).from_base);
    EXPECT_TRUE(sorted(viewer.mesh.read()) == sorted(fresh.mesh.read()));
    viewer.mesh.forget();
    EXPECT_TRUE(viewer.look_from(camera_at(200, 3, 9)).from_base);
    EXPECT_TRUE(sorted(viewer.mesh.read()) == sorted(fresh.mesh.read()));
}

/// Over the borders of base cells and windows: the mesh goes along without being made anew.
TEST_F(Coherent, the_window_follows_the_camera) {
    Viewer viewer({2.0F, 0.03F});
    std::set<int64_t> windows;
    for (int frame = 0; frame < 14; ++frame) {
        const CoherentWork work =
            viewer.look_from(camera_at(-5'000'000.0 + 4'321.0 * frame, 1'000.0 - 3'456.0 * frame, 25'000));
        EXPECT_EQ(work.from_base, frame == 0);
        windows.insert(viewer.mesh.window().x);
        viewer.expect_right();
        if (HasFailure()) return;
    }
    EXPECT_GE(windows.size(), 3U);
}

/// Each pattern on the GPU, there and back.
TEST_F(Coherent, every_pattern_refines_and_coarsens) {
    std::array<size_t, 8> used{};
    uint32_t dice = 12345;
    const auto roll = [&] {
        dice = dice * 1664525U + 1013904223U;
        return static_cast<double>(dice >> 8U) / 16777216.0;
    };
    for (int i = 0; i < 40; ++i) {
        // Spacings that soon reach a base cell's sides: few levels, all patterns.
        Viewer viewer({500.0F, static_cast<float>(0.1 + 0.5 * roll())},
                      i % 2 == 0 ? Refinement::distance : Refinement::screen);
        for (int k = 0; k < 4; ++k) {
            const double height = roll();
            viewer.look_from(camera_at(16'384 * roll(), 16'384 * roll(), 20'000 * height * height * height));
            viewer.expect_right();
            for (const CoherentTriangle& t : viewer.mesh.read())
                for (const int pattern : patterns_of(t)) ++used[static_cast<size_t>(pattern)];
        }
        viewer.look_from(camera_at(0, 0, 9'000'000));
        ASSERT_EQ(viewer.mesh.triangles(), 256U);
        viewer.expect_right();
    }
    for (size_t pattern = 1; pattern <= 7; ++pattern) {
        fmt::print("pattern {}: {}\n", pattern, used[pattern]);
        EXPECT_GT(used[pattern], 0U) << pattern;
    }
}

/// As deep as P goes: edges of a few lattice units, I and P in two words each.
TEST_F(Coherent, goes_22_levels_deep_and_back) {
    Viewer viewer({3.2F / 1024.0F, 0.1F});
    viewer.look_from(camera_at(4'321.125, -1'234.5, 0.001));
    viewer.expect_right();
    int deepest = 0;
    for (const CoherentTriangle& t : viewer.mesh.read())
        deepest = std::max(deepest, static_cast<int>(patterns_of(t).size()));
    EXPECT_EQ(deepest, 22);
    viewer.look_from(camera_at(4'321.125, -1'234.6, 0.002));
    viewer.expect_right();
    viewer.look_from(camera_at(4'321.125, -1'234.5, 5'000));
    viewer.expect_right();
}

/// A mesh that would be too large is coarser as a whole, never torn, and finer again where there is room.
TEST_F(Coherent, a_mesh_that_does_not_fit_becomes_coarser) {
    Viewer viewer;
    const CoherentWork whole = viewer.look_from(camera_at(0, 0, 3));
    EXPECT_EQ(viewer.mesh.coarser(), 1.0F);
    const uint32_t room = whole.triangles / 3;
    const CoherentWork less = viewer.look_from(camera_at(0, 0, 3), room);
    EXPECT_LE(less.triangles, room);
    EXPECT_GT(viewer.mesh.coarser(), 1.0F);
    viewer.expect_right();
    for (int frame = 0; frame < 20; ++frame) viewer.look_from(camera_at(0, 0, 3 + frame), 2'000'000);
    EXPECT_EQ(viewer.mesh.coarser(), 1.0F);
    viewer.expect_right();
}

/// Bar R2 for this mesher: the shaders' sea at its corners against the CPU's.
TEST_F(Coherent, the_sea_at_its_corners_is_the_cpus) {
    FixtureSource source(TerrainGrid{});
    const Camera camera = camera_at(7'654'321.5, -1'234.5, 6);
    source.set_view(view_of(camera, glm::dvec3(0)));
    DrawOptions options;
    options.mesher = MesherKind::coherent;
    options.authoritative = true;
    const SeaTime now{73'500'123};
    const Probe probe = probe_sea(source.state(), now, camera, options);
    target_->bind();
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (const auto& [id, box] : source.state().boxes) boxes.push_back(prepare(*box, {}));
    const SeaInstant sea(Sea(std::move(boxes)), now, displayed_layers);
    EXPECT_GT(probe.vertices.size(), 30'000U);
    EXPECT_EQ(probe.vertices.size() % 3, 0U);
    const bool exact = describe_gl().find("llvmpipe") != std::string::npos;
    size_t moved = 0;
    for (size_t i = 0; i < probe.vertices.size(); i += 41) {
        const ProbedVertex& v = probe.vertices[i];
        const SurfaceSample cpu = sea.evaluate({probe.anchor.x + v.x, probe.anchor.z + v.z});
        if (cpu.ay != 0.0F) ++moved;
        const float bound = exact ? 0.0F : 1e-4F;
        ASSERT_NEAR(cpu.ax, v.shift[0], bound);
        ASSERT_NEAR(cpu.ay, v.shift[1], bound);
        ASSERT_NEAR(cpu.az, v.shift[2], bound);
        ASSERT_NEAR(cpu.nx, v.normal[0], bound);
        ASSERT_NEAR(cpu.ny, v.normal[1], bound);
        ASSERT_NEAR(cpu.nz, v.normal[2], bound);
    }
    EXPECT_GT(moved, 500U);
}

using Place = std::pair<int32_t, int32_t>;
using Places = std::array<Place, 3>;

Places places_of(const Probe& probe, size_t first) {
    Places places;
    for (size_t k = 0; k < 3; ++k) places[k] = {probe.vertices[first + k].x, probe.vertices[first + k].z};
    return places;
}

/// Metres from the camera, as emit_surface places a vertex.
glm::vec3 shown_at(const CameraFrame& frame, const Probe& probe, const ProbedVertex& v) {
    glm::vec3 p = metres_from_camera(frame, {probe.anchor.x + v.x, probe.anchor.z + v.z}, double{v.shift[1]});
    p -= glm::vec3(v.shift[0], 0.0F, v.shift[2]);
    p.y -= (p.x * p.x + p.z * p.z) * static_cast<float>(0.5 / earth_radius);
    return p;
}

/// Row A10: the mesh is all around, its waves are summed up in view only. What is left out would not have been seen, and what is drawn
/// is the same to the bit.
TEST_F(Coherent, sums_waves_only_where_they_may_be_in_view) {
    FixtureSource source(TerrainGrid{});
    WaveTrainBox high;
    high.id = {9};
    high.first_train = {900};
    high.begin = {-sea_time_bound};
    high.trains = {deep_train(90.0, 0.3, 2.5F, 1.0F, 0), deep_train(60.0, 2.0, 1.5F, 1.0F, 77)};
    source.add_box(high);
    DrawOptions options;
    options.mesher = MesherKind::coherent;
    options.error_px = 12.0F;  // probe_sea's
    const SeaTime now{5'000'000};
    for (const Refinement refinement : {Refinement::distance, Refinement::screen})
        for (const Camera& camera : {camera_at(12.5, -7.25, 4, 0.7, -0.1), camera_at(0, 0, 60, 2.2, -0.9)}) {
            SCOPED_TRACE(name_of(refinement));
            options.refinement = refinement;
            const Probe all = probe_sea(source.state(), now, camera, options);
            const Probe seen = probe_view(source.state(), now, camera, options);
            target_->bind();
            std::map<Places, std::array<float, 6>> drawn;
            for (size_t i = 0; i < seen.vertices.size(); i += 3) {
                const ProbedVertex& v = seen.vertices[i];
                drawn[places_of(seen, i)] = {v.shift[0],  v.shift[1],  v.shift[2],
                                             v.normal[0], v.normal[1], v.normal[2]};
            }
            EXPECT_LT(seen.vertices.size(), all.vertices.size() / 2) << "little is left out";
            const CameraFrame frame = frame_of(camera, DepthRange::classic);
            const FrustumPlanes planes = planes_of(frame, DepthRange::classic);
            size_t in_view = 0;
            for (size_t i = 0; i < all.vertices.size(); i += 3) {
                const auto found = drawn.find(places_of(all, i));
                const ProbedVertex& v = all.vertices[i];
                bool corner_in_view = false;
                for (size_t k = 0; k < 3; ++k) {
                    const glm::vec3 p = shown_at(frame, all, all.vertices[i + k]);
                    corner_in_view = corner_in_view || may_see(planes, {p, p});
                }
                if (corner_in_view) {
                    ++in_view;
                    ASSERT_NE(found, drawn.end()) << "in view, but left out";
                }
                if (found == drawn.end()) continue;
                const std::array<float, 6> whole{v.shift[0],  v.shift[1],  v.shift[2],
                                                 v.normal[0], v.normal[1], v.normal[2]};
                ASSERT_EQ(found->second, whole);
            }
            EXPECT_GT(in_view, 1'000U);
            fmt::print("{}: {} triangles, {} listed, {} with a corner in view\n", name_of(refinement),
                       all.vertices.size() / 3, drawn.size(), in_view);
        }
}

Picture picture_of(const Camera& camera, FixtureSource& source, const DrawOptions& options) {
    ViewState view = view_of(camera, glm::dvec3(0));
    view.accepted_error_px = options.error_px;
    source.set_view(view);
    Renderer renderer;
    const RenderTarget target(camera.width, camera.height, 1);
    renderer.draw(target, source.snapshot(), camera, camera, options);
    return target.read();
}

Camera small(Camera camera) {
    camera.width = 320;
    camera.height = 180;
    return camera;
}

/// Nothing of the background shows through the sea, by any criterion and through either mesher that follows it.
TEST_F(Coherent, no_background_shows_through_by_any_criterion) {
    const Camera camera = small(camera_at(-777.7, 1'234.5, 45, 2.9, -0.7));
    for (const MesherKind mesher : {MesherKind::coherent, MesherKind::patches})
        for (const Refinement refinement : {Refinement::distance, Refinement::screen, Refinement::frustum}) {
            FixtureSource source(TerrainGrid{});
            DrawOptions options;
            options.mesher = mesher;
            options.refinement = refinement;
            options.sky = options.far_sea = options.land = options.spray = false;
            options.clear_colour = {1.0F, 0.0F, 1.0F};
            const Picture picture = picture_of(camera, source, options);
            size_t magenta = 0;
            for (size_t i = 0; i < picture.rgb.size(); i += 3)
                if (picture.rgb[i] > 250 && picture.rgb[i + 1] < 5 && picture.rgb[i + 2] > 250) ++magenta;
            EXPECT_EQ(magenta, 0U) << name_of(mesher) << " by " << name_of(refinement);
        }
}

/// A target may go between two pictures, as where the window is resized: the mesh is made all the same.
TEST_F(Coherent, another_target_shows_the_same) {
    Camera camera = small(camera_at(10, 20, 30, 0.4, -0.5));
    FixtureSource source(TerrainGrid{});
    source.set_view(view_of(camera, glm::dvec3(0)));
    DrawOptions options;
    options.mesher = MesherKind::coherent;
    options.sky = options.far_sea = options.land = options.spray = options.foam_history = false;
    Renderer renderer;
    const auto picture = [&] {
        const RenderTarget target(camera.width, camera.height, 1);
        renderer.draw(target, source.snapshot(), camera, camera, options);
        return target.read();
    };
    picture();
    camera.yaw += 0.5;
    const Picture turned = picture();
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    EXPECT_TRUE(turned == picture_of(camera, source, options));
    target_->bind();
}

/// Row D9: land by the coherent mesh is land as its tiles show it.
TEST_F(Coherent, land_looks_like_its_tiles) {
    const TerrainGrid terrain = shipped_terrain();
    if (terrain.columns == 0) GTEST_SKIP() << "no terrain";
    FixtureSource source(terrain);
    const Camera camera = small(camera_at(-900, -2'600, 150, 0.5, -0.26));
    DrawOptions options;
    options.spray = false;
    const Picture none = [&] {
        DrawOptions without = options;
        without.land = false;
        return picture_of(camera, source, without);
    }();
    const Picture tiles = picture_of(camera, source, options);
    options.coherent_land = true;
    const Picture coherent = picture_of(camera, source, options);
    const auto difference = [](const Picture& a, const Picture& b) {
        double sum = 0;
        for (size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(int{a.rgb[i]} - int{b.rgb[i]});
        return sum / static_cast<double>(a.rgb.size());
    };
    fmt::print("mean difference {:.2f} of 255, without land {:.2f}\n", difference(tiles, coherent),
               difference(tiles, none));
    EXPECT_LT(difference(tiles, coherent), 3.0);
    // Without land the sea's shader shows bare ground in its place: flat and without plants.
    EXPECT_GT(difference(tiles, none), 5.0);
}

}  // namespace
}  // namespace trochoid
