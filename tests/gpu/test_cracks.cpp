// No mesher's sea has cracks: every inner edge belongs to two triangles, what triangles share is the same to the bit, and no
// background shows through.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <tuple>

#include "client/gpu/offscreen_context.hpp"
#include "client/scene/projected_grid.hpp"
#include "tests/gpu/mesher_cases.hpp"
#include "tests/gpu/sea_probe.hpp"

namespace trochoid {
namespace {

using Place = std::pair<int32_t, int32_t>;
using Edges = std::map<std::pair<Place, Place>, int>;

/// Edges by place, with the number of triangles that have each; triangles without an area are left out.
Edges edges_of(const Probe& probe) {
    Edges uses;
    for (size_t i = 0; i + 2 < probe.vertices.size(); i += 3)
        for (size_t k = 0; k < 3; ++k) {
            const ProbedVertex& a = probe.vertices[i + k];
            const ProbedVertex& b = probe.vertices[i + (k + 1) % 3];
            const Place p{a.x, a.z};
            const Place q{b.x, b.z};
            if (p != q) ++uses[std::minmax(p, q)];
        }
    return uses;
}

/// Edges of the patches' triangles that no second triangle shares and that do not lie on the outline of the whole mesh.
size_t open_edges(const Probe& probe, const InterestState& state) {
    const auto covered = [&](int64_t x, int64_t z) {
        for (int level = finest_patch_level; level <= coarsest_patch_level; ++level)
            if (state.patches.contains({static_cast<uint8_t>(level), static_cast<int32_t>(x >> level),
                                        static_cast<int32_t>(z >> level)}))
                return true;
        return false;
    };
    size_t open = 0;
    for (const auto& [edge, count] : edges_of(probe)) {
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

/// Edges of a square mesh that not two triangles share, the square's sides apart.
size_t open_edges_of_square(const Edges& edges) {
    Place low{INT32_MAX, INT32_MAX};
    Place high{INT32_MIN, INT32_MIN};
    for (const auto& [edge, count] : edges)
        for (const Place& p : {edge.first, edge.second}) {
            low = {std::min(low.first, p.first), std::min(low.second, p.second)};
            high = {std::max(high.first, p.first), std::max(high.second, p.second)};
        }
    size_t open = 0;
    for (const auto& [edge, count] : edges) {
        const auto& [p, q] = edge;
        const bool outline = (p.first == q.first && (p.first == low.first || p.first == high.first)) ||
                             (p.second == q.second && (p.second == low.second || p.second == high.second));
        if (count != (outline ? 1 : 2)) ++open;
    }
    return open;
}

/// Places at which vertices differ in any bit of what was computed there.
size_t places_with_different_bits(const Probe& probe) {
    std::map<Place, const ProbedVertex*> first;
    size_t differing = 0;
    for (const ProbedVertex& v : probe.vertices) {
        const auto [at, added] = first.try_emplace(Place{v.x, v.z}, &v);
        if (!added && std::memcmp(at->second, &v, sizeof v) != 0) ++differing;
    }
    return differing;
}

class Cracks : public testing::Test {
protected:
    static void SetUpTestSuite() { context_ = std::make_unique<OffscreenContext>(); }
    static void TearDownTestSuite() { context_.reset(); }
    static std::unique_ptr<OffscreenContext> context_;
};
std::unique_ptr<OffscreenContext> Cracks::context_;

class EveryMesher : public Cracks, public testing::WithParamInterface<MesherKind> {};
INSTANTIATE_TEST_SUITE_P(Cracks, EveryMesher, testing::ValuesIn(all_meshers),
                         [](const auto& kind) { return std::string(name_of(kind.param)); });

TEST_P(EveryMesher, shares_inner_edges_and_the_bits_of_shared_places) {
    for (const Camera& base : {standing_at(10.3, 7.1, 3, 0, 0), standing_at(-777.7, 1'234.5, 40, 2.2, -0.3),
                               standing_at(31'415'926, -2'718'281, 900, 0, -0.2)}) {
        Camera camera = probing(base);
        DrawOptions options;
        options.mesher = GetParam();
        options.error_px = 12.0F;
        options.projected_rows = 150;
        options.projected_columns = 100;
        const auto source = open_sea(camera, false, options);
        const Probe probe = probe_sea(source->state(), SeaTime{1'000'000}, camera, options);
        EXPECT_GT(probe.vertices.size(), 20'000U);
        EXPECT_EQ(places_with_different_bits(probe), 0U);
        if (GetParam() == MesherKind::patches) {
            EXPECT_EQ(open_edges(probe, source->state()), 0U);
            continue;
        }
        const Edges edges = edges_of(probe);
        if (GetParam() != MesherKind::projected) {
            EXPECT_EQ(open_edges_of_square(edges), 0U);
            continue;
        }
        const auto unshared =
            std::count_if(edges.begin(), edges.end(), [](const auto& e) { return e.second != 2; });
        const size_t quads = probe.vertices.size() / 6;
        EXPECT_EQ(quads, 150U * 100U);
        EXPECT_EQ(unshared, 2 * (150 + 100)) << "the grid's outline and nothing else";
    }
}

/// The filter by direction, whatever way cells lie on the lattice.
TEST_F(Cracks, the_projected_grid_shares_bits_in_every_direction) {
    DrawOptions options;
    options.mesher = MesherKind::projected;
    options.projected_rows = 120;
    options.projected_columns = 90;
    for (const double yaw : {0.2, 0.785398, 1.570796, 2.5, 3.9, 5.4})
        for (const double pitch : {-0.02, -0.5, -1.5}) {
            Camera camera = probing(standing_at(-777.7, 1'234.5, 8, yaw, pitch));
            const auto source = open_sea(camera, false, options);
            const Probe probe = probe_view(source->state(), SeaTime{1'000'000}, camera, options);
            EXPECT_GT(probe.vertices.size(), 10'000U);
            EXPECT_EQ(places_with_different_bits(probe), 0U) << "yaw " << yaw << " pitch " << pitch;
        }
}

/// Shows that the test above can fail: two levels apart is more than the edges agree about.
TEST_F(Cracks, neighbours_two_levels_apart_would_be_seen) {
    InterestState state;
    state.patches[{17, 0, 0}] = {};
    state.patches[{15, 4, 0}] = {};
    state.patches[{15, 4, 1}] = {};
    const Probe probe = probe_sea(state, SeaTime{}, probing(standing_at(100, 50, 5, 0, 0)));
    EXPECT_GT(open_edges(probe, state), 0U);
}

/// The most that waves do in a state, m.
WaveBounds waves_of(const InterestState& state) {
    LandTable land;
    land.rebuild(state, 1U << 20, 1U << 20);
    SeaTable table;
    table.rebuild(state, land);
    return table.bounds_of_list(0);
}

/// How far a mesher's sea reaches at least, m along the sea.
double reach_of(const DrawOptions& options) {
    switch (options.mesher) {
        case MesherKind::uniform:
            return (options.grid_cells * 0.5 - 2.0) * static_cast<double>(options.grid_spacing_m);
        case MesherKind::projected: return 1e9;
        case MesherKind::patches:
        case MesherKind::coherent: break;
    }
    // The fixture's patches end 10 km away or farther.
    return 9'900.0;
}

TEST_P(EveryMesher, lets_no_background_show_through) {
    Painter painter;
    for (const NamedView& view : demanding_views()) {
        SCOPED_TRACE(view.name);
        Camera camera = view.camera;
        DrawOptions options = bare(GetParam());
        options.grid_cells = 512;
        const auto source = open_sea(camera, view.storm, options);
        const WaveBounds waves = waves_of(source->state());
        const Picture picture = painter.picture(*source, camera, camera, options);
        size_t water = 0;
        size_t holes = 0;
        for (uint32_t y = 0; y < picture.height; ++y)
            for (uint32_t x = 0; x < picture.width; ++x) {
                // A pixel off the horizon: where the sea ends is a matter of rounding.
                const double away = water_distance(camera, x, y, waves.height);
                if (away < 0 || water_distance(camera, x, y == 0 ? 0 : y - 1, 0) < 0) continue;
                if (away + static_cast<double>(waves.displacement) > reach_of(options)) continue;
                ++water;
                if (is_background(picture, x, y)) ++holes;
            }
        EXPECT_EQ(holes, 0U) << "of " << water << " pixels from " << camera.altitude_m << " m";
        if (view.name == "straight down") {
            EXPECT_EQ(water, size_t{picture.width} * picture.height);
        }
    }
}

/// Shows that the test above can fail.
TEST_F(Cracks, a_grid_too_small_would_be_seen) {
    Camera camera = standing_at(4'000.5, -3'141.5, 60, -1.1, -1.5);
    DrawOptions options = bare(MesherKind::uniform);
    options.grid_cells = 32;
    options.grid_spacing_m = 1.0F;
    const auto source = open_sea(camera, false, options);
    const Picture picture = Painter().picture(*source, camera, camera, options);
    EXPECT_TRUE(is_background(picture, 2, 2));
}

}  // namespace
}  // namespace trochoid
