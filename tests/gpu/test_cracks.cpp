// The sea's mesh has no cracks: every inner edge belongs to two triangles, and no background shows through.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "client/gpu/offscreen_context.hpp"
#include "client/gpu/renderer.hpp"
#include "tests/gpu/fixture_sea.hpp"
#include "tests/gpu/sea_probe.hpp"

namespace trochoid {
namespace {

using Place = std::pair<int32_t, int32_t>;

/// Edges of the triangles that no second triangle shares and that do not lie on the outline of the whole mesh.
size_t open_edges(const Probe& probe, const InterestState& state) {
    std::map<std::pair<Place, Place>, int> uses;
    for (size_t i = 0; i + 2 < probe.vertices.size(); i += 3)
        for (size_t k = 0; k < 3; ++k) {
            const ProbedVertex& a = probe.vertices[i + k];
            const ProbedVertex& b = probe.vertices[i + (k + 1) % 3];
            const Place p{a.x, a.z};
            const Place q{b.x, b.z};
            if (p != q) ++uses[std::minmax(p, q)];
        }
    const auto covered = [&](int64_t x, int64_t z) {
        for (int level = finest_patch_level; level <= coarsest_patch_level; ++level)
            if (state.patches.contains({static_cast<uint8_t>(level), static_cast<int32_t>(x >> level),
                                        static_cast<int32_t>(z >> level)}))
                return true;
        return false;
    };
    size_t open = 0;
    for (const auto& [edge, count] : uses) {
        if (count == 2) continue;
        // Just beside the middle of the edge, on both sides: water on both means that the edge should have been shared.
        const int64_t x = probe.anchor.x + (int64_t{edge.first.first} + edge.second.first) / 2;
        const int64_t z = probe.anchor.z + (int64_t{edge.first.second} + edge.second.second) / 2;
        const bool along_x = edge.first.second == edge.second.second;
        const bool inner = along_x ? covered(x, z - 1) && covered(x, z) : covered(x - 1, z) && covered(x, z);
        if (inner || count > 2) ++open;
    }
    return open;
}

Camera standing_at(double x, double z, double altitude, double yaw, double pitch) {
    Camera camera;
    camera.position = {to_lattice(x), to_lattice(z)};
    camera.fraction_x = 0.25;
    camera.altitude_m = altitude;
    camera.yaw = yaw;
    camera.pitch = pitch;
    return camera;
}

class Cracks : public testing::Test {
protected:
    static void SetUpTestSuite() { context_ = std::make_unique<OffscreenContext>(); }
    static void TearDownTestSuite() { context_.reset(); }
    static std::unique_ptr<OffscreenContext> context_;
};
std::unique_ptr<OffscreenContext> Cracks::context_;

TEST_F(Cracks, every_inner_edge_belongs_to_two_triangles) {
    for (const Camera& camera : {standing_at(10.3, 7.1, 3, 0, 0), standing_at(-777.7, 1'234.5, 40, 0, 0),
                                 standing_at(31'415'926, -2'718'281, 900, 0, 0)}) {
        FixtureSource source(TerrainGrid{});
        ViewState view = view_of(camera, glm::dvec3(0));
        view.accepted_error_px = 12.0F;
        source.set_view(view);
        const Probe probe = probe_sea(source.state(), SeaTime{1'000'000}, camera);
        EXPECT_GT(probe.vertices.size(), 30'000U);
        EXPECT_EQ(open_edges(probe, source.state()), 0U);
    }
}

/// Shows that the test above can fail: two levels apart is more than the edges agree about.
TEST_F(Cracks, neighbours_two_levels_apart_would_be_seen) {
    InterestState state;
    state.patches[{17, 0, 0}] = {};
    state.patches[{15, 4, 0}] = {};
    state.patches[{15, 4, 1}] = {};
    const Probe probe = probe_sea(state, SeaTime{}, standing_at(100, 50, 5, 0, 0));
    EXPECT_GT(open_edges(probe, state), 0U);
}

TEST_F(Cracks, no_background_shows_through_the_sea) {
    Renderer renderer;
    for (const Camera& base :
         {standing_at(10.3, 7.1, 6, 0.7, -1.2), standing_at(-777.7, 1'234.5, 45, 2.9, -0.9),
          standing_at(4'000.5, -3'141.5, 700, -1.1, -0.8)}) {
        Camera camera = base;
        camera.width = 640;
        camera.height = 360;
        FixtureSource source(TerrainGrid{});
        DrawOptions options;
        options.sky = options.far_sea = options.land = false;
        options.clear_colour = {1.0F, 0.0F, 1.0F};
        ViewState view = view_of(camera, glm::dvec3(0));
        view.accepted_error_px = options.error_px;
        source.set_view(view);
        const RenderTarget target(camera.width, camera.height, 1);
        renderer.draw(target, source.snapshot(), camera, camera, options);
        const Picture picture = target.read();
        size_t magenta = 0;
        for (size_t i = 0; i < picture.rgb.size(); i += 3)
            if (picture.rgb[i] > 250 && picture.rgb[i + 1] < 5 && picture.rgb[i + 2] > 250) ++magenta;
        EXPECT_EQ(magenta, 0U) << "from " << camera.altitude_m << " m";
    }
}

}  // namespace
}  // namespace trochoid
