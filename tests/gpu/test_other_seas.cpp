// Seas for comparison: what the shaders sample is what the CPU made, under every mesher, without cracks.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "client/gpu/offscreen_context.hpp"
#include "client/scene/fft_sea.hpp"
#include "tests/gpu/fixture_sea.hpp"
#include "tests/gpu/sea_probe.hpp"

namespace trochoid {
namespace {

class OtherSeasOnGpu : public testing::TestWithParam<std::tuple<Displacement, MesherKind>> {
protected:
    static void SetUpTestSuite() { context_ = std::make_unique<OffscreenContext>(); }
    static void TearDownTestSuite() { context_.reset(); }
    static std::unique_ptr<OffscreenContext> context_;
};
std::unique_ptr<OffscreenContext> OtherSeasOnGpu::context_;

TEST_P(OtherSeasOnGpu, is_as_high_as_the_sea_and_without_cracks) {
    Camera camera;
    camera.position = {to_lattice(120.3), to_lattice(-77.1)};
    camera.altitude_m = 12;
    FixtureSource source(TerrainGrid{});
    ViewState view = view_of(camera, glm::dvec3(0));
    view.accepted_error_px = 12.0F;
    source.set_view(view);
    DrawOptions options;
    options.displacement = std::get<0>(GetParam());
    options.mesher = std::get<1>(GetParam());
    const Probe probe = probe_sea(source.state(), SeaTime{60'000'000}, camera, options);
    ASSERT_GT(probe.vertices.size(), 3000U);

    std::map<std::pair<int32_t, int32_t>, const ProbedVertex*> seen;
    double squares = 0;
    size_t near = 0;
    for (const ProbedVertex& v : probe.vertices) {
        const auto [at, first] = seen.try_emplace({v.x, v.z}, &v);
        if (!first) {
            ASSERT_EQ(at->second->shift[1], v.shift[1]) << v.x << " " << v.z;
            ASSERT_EQ(at->second->normal[0], v.normal[0]);
            continue;
        }
        // Farther away less and less is displayed.
        const double east = to_metres(probe.anchor.x + v.x - camera.position.x);
        const double south = to_metres(probe.anchor.z + v.z - camera.position.z);
        if (std::hypot(east, south) > 150) continue;
        squares += static_cast<double>(v.shift[1]) * static_cast<double>(v.shift[1]);
        ++near;
    }
    LandTable land;
    land.rebuild(source.state(), 1U << 27, 1U << 27);
    SeaTable table;
    table.rebuild(source.state(), land);
    const double height =
        static_cast<double>(table.weather_at(camera.position, SeaTime{60'000'000}, 1.0F).height_m);
    const double measured = 4 * std::sqrt(squares / static_cast<double>(near));
    EXPECT_GT(measured, 0.5 * height);
    EXPECT_LT(measured, 1.5 * height);
}

INSTANTIATE_TEST_SUITE_P(EachUnderEachMesher, OtherSeasOnGpu,
                         testing::Combine(testing::Values(Displacement::noise, Displacement::fft),
                                          testing::Values(MesherKind::patches, MesherKind::uniform,
                                                          MesherKind::projected, MesherKind::coherent)),
                         [](const auto& tested) {
                             return std::string(name_of(std::get<0>(tested.param))) + "_" +
                                    std::string(name_of(std::get<1>(tested.param)));
                         });

/// Where the mesh is finer than the tile's samples the shader's heights are those of the transform, bilinear between.
TEST(FftOnGpu, heights_are_those_of_the_transform) {
    const OffscreenContext context;
    Camera camera;
    camera.position = {0, 0};
    camera.altitude_m = 4;
    FixtureSource source(TerrainGrid{});
    source.set_view(view_of(camera, glm::dvec3(0)));
    DrawOptions options;
    options.displacement = Displacement::fft;
    options.mesher = MesherKind::uniform;
    options.grid_spacing_m = 1.0F;
    options.grid_cells = 128;
    const SeaTime now{60'000'000};
    const Probe probe = probe_sea(source.state(), now, camera, options);
    LandTable land;
    land.rebuild(source.state(), 1U << 27, 1U << 27);
    SeaTable table;
    table.rebuild(source.state(), land);
    const SeaWeather weather = table.weather_at(camera.position, now, 1.0F);
    FftSeaSettings settings;
    settings.significant_height = std::max(std::round(weather.height_m * 16.0F) / 16.0F, 0.0625F);
    const float length = std::hypot(weather.heading.x, weather.heading.y);
    settings.heading = weather.heading / length;
    FftSea sea(settings);
    sea.transform(60.0);
    const int sample = 1 << (settings.tile_log2 - 8);
    size_t compared = 0;
    for (const ProbedVertex& v : probe.vertices) {
        const int64_t x = probe.anchor.x + v.x;
        const int64_t z = probe.anchor.z + v.z;
        if (x % sample != 0 || z % sample != 0 || std::max(std::abs(x), std::abs(z)) > 20 * 1024) continue;
        const auto column = static_cast<size_t>(((x / sample) % 256 + 256) % 256);
        const auto row = static_cast<size_t>(((z / sample) % 256 + 256) % 256);
        EXPECT_NEAR(v.shift[1], sea.displaced()[row * 256 + column].y, 2e-3F);
        ++compared;
    }
    EXPECT_GT(compared, 50U);
}

}  // namespace
}  // namespace trochoid
