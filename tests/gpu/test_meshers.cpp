// All meshers show the same sea: bit for bit where they evaluate it, nearly the same pictures where they are fine, and quiet ones
// in motion.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "client/gpu/offscreen_context.hpp"
#include "tests/gpu/mesher_cases.hpp"
#include "tests/gpu/sea_comparison.hpp"
#include "tests/gpu/sea_probe.hpp"

namespace trochoid {
namespace {

class Meshers : public testing::Test {
protected:
    static void SetUpTestSuite() { context_ = std::make_unique<OffscreenContext>(); }
    static void TearDownTestSuite() { context_.reset(); }
    static std::unique_ptr<OffscreenContext> context_;
};
std::unique_ptr<OffscreenContext> Meshers::context_;

class EveryMesher : public Meshers, public testing::WithParamInterface<MesherKind> {};
INSTANTIATE_TEST_SUITE_P(Meshers, EveryMesher, testing::ValuesIn(all_meshers),
                         [](const auto& kind) { return std::string(name_of(kind.param)); });

/// Bar R2, over a coast with fields and far from everything.
TEST_P(EveryMesher, evaluates_the_sea_of_the_model) {
    FixtureSource coast(shipped_terrain());
    Camera camera = probing(standing_at(-900, -2'600, 20, 0.4, -0.1));
    DrawOptions options;
    options.mesher = GetParam();
    options.error_px = 12.0F;
    options.projected_rows = 150;
    options.projected_columns = 100;
    for (int i = 0; i < 2; ++i) {
        ViewState view = view_of(camera, glm::dvec3(0));
        view.accepted_error_px = options.error_px;
        coast.set_view(view);
        const Comparison c = compare_sea(
            coast.state(), SeaTime{int64_t{i} * 315'576'000'987'654 + 73'500'123}, camera, options);
        EXPECT_GT(c.vertices, 4'000U);
        EXPECT_GT(c.moved, c.vertices / 4);
        EXPECT_EQ(c.phase_differs, 0U);
        EXPECT_LE(c.worst_mm, 0.1);
        EXPECT_LE(c.worst_normal, 1e-4);
        // Software GL rounds as C++ does; a GPU may differ in the last bits, within the bound above.
        if (describe_gl().find("llvmpipe") != std::string::npos) {
            EXPECT_EQ(c.bits_differ, 0U);
        }
        camera = probing(standing_at(9'876'543.21, -7'654'321.9, 150, 2.0, -0.6));
    }
}

/// Rows B6 and B7: trains come by falling wavelength, so the first without a share ends a vertex's sum.
TEST_P(EveryMesher, looks_at_few_trains_that_are_not_shown) {
    Camera camera = standing_at(10.3, 7.1, 12, 0.9, -0.1);
    DrawOptions options;
    options.mesher = GetParam();
    const auto source = open_sea(camera, false, options);
    const Probe probe = probe_view(source->state(), SeaTime{1'000'000}, camera, options);
    double looked_at = 0;
    double evaluated = 0;
    for (const ProbedVertex& v : probe.vertices) {
        looked_at += v.trains_looked_at;
        evaluated += v.trains_evaluated;
    }
    const auto vertices = static_cast<double>(probe.vertices.size());
    fmt::print("{}: {:.2f} trains evaluated, {:.2f} looked at a vertex, of 32 in 2 boxes\n",
               name_of(GetParam()), evaluated / vertices, looked_at / vertices);
    EXPECT_GT(evaluated / vertices, 1.0);
    EXPECT_LT(evaluated / vertices, 31.0) << "something must have been left out";
    // Where a mesh filters by direction, waves along its cells may go while shorter ones across them stay.
    const double more = GetParam() == MesherKind::projected ? 4 : 2;
    EXPECT_LE(looked_at, evaluated + more * vertices) << "at most one test more a box";
}

/// Differences of two pictures' channels, by rising size.
std::vector<int> differences(const Picture& a, const Picture& b) {
    std::vector<int> all(a.rgb.size());
    for (size_t i = 0; i < all.size(); ++i) all[i] = std::abs(int{a.rgb[i]} - int{b.rgb[i]});
    std::sort(all.begin(), all.end());
    return all;
}
double mean(const std::vector<int>& values) {
    double sum = 0;
    for (const int v : values) sum += v;
    return sum / static_cast<double>(values.size());
}
int at_share(const std::vector<int>& values, double share) {
    return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
}

/// What changes from frame to frame, of 255.
struct Flicker {
    double median = 0;   // of the frames' mean differences
    double largest = 0;  // of the frames' mean differences
    int high = 0;        // 99.9 percentile of the differences in the worst frame
};

/// What of a slow flight moves: the camera with its mesh, or the mesh alone, so that whatever changes is the mesh's doing; or the
/// mesh turns about a camera that stands.
enum class Moving : uint8_t { camera, mesh, turning_mesh };
constexpr const char* name_of(Moving moving) {
    return moving == Moving::camera ? "the camera moves"
           : moving == Moving::mesh ? "the mesh alone moves"
                                    : "the mesh alone turns";
}

/// 0.2 m ahead and 5 mm up a frame over a sea that stands still; the mesh alone goes backwards, so that it covers the picture; or 3 mrad a
/// frame, 0.2 rad/s at 60 frames a second, made for a wider view.
Flicker flicker_of(MesherKind kind, Moving moving, bool filtered) {
    Camera camera = standing_at(12.5, 8.5, 25, 0.6, -0.25);
    camera.width = 384;
    camera.height = 216;
    DrawOptions options = bare(kind);
    options.sky = options.far_sea = true;
    options.authoritative = !filtered;
    const auto source = open_sea(camera, false, options);
    Painter painter;
    Camera meshed = camera;
    if (moving == Moving::turning_mesh) meshed.vertical_angle *= 1.2;
    Picture before = painter.picture(*source, camera, meshed, options);
    std::vector<double> means;
    Flicker flicker;
    for (int frame = 0; frame < 20; ++frame) {
        const double step = moving == Moving::camera ? 0.2 : -0.2;
        if (moving == Moving::turning_mesh)
            meshed.yaw += 0.003;
        else
            move(meshed, step * std::sin(camera.yaw), 0.005, -step * std::cos(camera.yaw));
        if (moving == Moving::camera) camera = meshed;
        Picture next = painter.picture(*source, camera, meshed, options);
        const std::vector<int> changes = differences(before, next);
        means.push_back(mean(changes));
        flicker.high = std::max(flicker.high, at_share(changes, 0.999));
        before = std::move(next);
    }
    std::sort(means.begin(), means.end());
    flicker.median = means[means.size() / 2];
    flicker.largest = means.back();
    fmt::print("{}{}, {}: mean difference {:.3f}, in the worst frame {:.3f}, 99.9 percentile {}\n",
               name_of(kind), filtered ? "" : " without the filter", name_of(moving), flicker.median,
               flicker.largest, flicker.high);
    return flicker;
}

TEST_P(EveryMesher, changes_evenly_in_a_slow_flight) {
    const Flicker f = flicker_of(GetParam(), Moving::camera, true);
    EXPECT_GT(f.median, 0.3) << "a picture that stands still proves nothing";
    EXPECT_LT(f.median, 3.0);
    EXPECT_LT(f.largest, 1.5 * f.median) << "a frame that jumps";
    // The sun's glitter goes from dark to white in a frame.
    EXPECT_LE(f.high, 160);
}

constexpr double most_popping = 0.25;
constexpr int most_high_popping = 20;

TEST_P(EveryMesher, does_not_pop) {
    for (const Moving moving : {Moving::mesh, Moving::turning_mesh}) {
        const Flicker f = flicker_of(GetParam(), moving, true);
        EXPECT_LT(f.largest, most_popping);
        EXPECT_LE(f.high, most_high_popping);
    }
}

/// Shows that the test above can fail: waves shorter than the grid's cells change shape as it slides over them.
TEST_F(Meshers, popping_would_be_seen_without_the_filter) {
    const Flicker f = flicker_of(MesherKind::projected, Moving::mesh, false);
    EXPECT_GT(f.median, 2 * most_popping);
    EXPECT_GT(2 * f.high, 3 * most_high_popping);
}

/// Where all are as fine as waves are shown, all pictures show the same.
TEST_P(EveryMesher, shows_the_same_sea_as_the_others) {
    Camera camera = standing_at(12.5, 8.5, 14, 0.6, -1.1);
    camera.width = 480;
    camera.height = 270;
    DrawOptions options = bare(MesherKind::patches);
    options.error_px = 2.0F;
    options.projected_rows = 300;
    options.projected_columns = 300;
    options.grid_cells = 256;
    options.grid_spacing_m = 0.5F;
    const auto source = open_sea(camera, false, options);
    Painter painter;
    const Picture patches = painter.picture(*source, camera, camera, options);
    options.mesher = GetParam();
    const std::vector<int> same = differences(patches, painter.picture(*source, camera, camera, options));
    fmt::print("{} and patches: median difference {}, mean {:.3f}, 99 percentile {}\n", name_of(GetParam()),
               at_share(same, 0.5), mean(same), at_share(same, 0.99));
    EXPECT_LE(at_share(same, 0.5), 2);
    EXPECT_LT(mean(same), 2.0);
    // Two seconds later it is another sea.
    source->set_time(source->sea_time_now() + 2'000'000);
    const std::vector<int> other = differences(patches, painter.picture(*source, camera, camera, options));
    EXPECT_GT(mean(other), 3 * mean(same));
}

/// Row B4: the same number of rows, moved to where they are wanted.
TEST_F(Meshers, attention_moves_rows) {
    Camera camera = standing_at(10.3, 7.1, 12, 0.9, -0.1);
    DrawOptions options;
    options.mesher = MesherKind::projected;
    const auto source = open_sea(camera, false, options);
    double near_before = 1e9;
    for (const float attention : {0.5F, 1.0F, 2.0F}) {
        options.attention = attention;
        const Probe probe = probe_view(source->state(), SeaTime{1'000'000}, camera, options);
        double trains = 0;
        double far = 0;
        for (const ProbedVertex& v : probe.vertices) {
            const double away = std::hypot(to_metres(probe.anchor.x + v.x - camera.position.x),
                                           to_metres(probe.anchor.z + v.z - camera.position.z));
            trains += v.trains_evaluated;
            far += away > 150.0 ? 1 : 0;
        }
        EXPECT_LT(far, near_before) << "fewer far rows at attention " << attention;
        EXPECT_GT(trains, 0.0);
        near_before = far;
    }
}

}  // namespace
}  // namespace trochoid
