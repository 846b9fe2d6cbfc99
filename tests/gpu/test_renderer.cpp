// What the renderer tells of a picture, and what a lean one leaves out.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "client/gpu/offscreen_context.hpp"
#include "client/gpu/renderer.hpp"
#include "tests/gpu/fixture_sea.hpp"

namespace trochoid {
namespace {

class Pictures : public testing::Test {
protected:
    Pictures() : target_(480, 270, 1) {
        camera_.altitude_m = 12;
        camera_.pitch = -0.1;
        camera_.width = 480;
        camera_.height = 270;
    }
    FrameReport draw(const DrawOptions& options) {
        ViewState view = view_of(camera_, glm::dvec3(0));
        view.accepted_error_px = options.error_px;
        source_.set_view(view);
        const auto start = std::chrono::steady_clock::now();
        FrameReport report = renderer_.draw(target_, source_.snapshot(), camera_, camera_, options);
        RenderTarget::finish();
        took_ms_ =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        return report;
    }

    OffscreenContext context_;
    FixtureSource source_{TerrainGrid{}};
    Camera camera_;
    RenderTarget target_;
    Renderer renderer_;
    double took_ms_ = 0;
};

/// On the processor timestamps say nothing; waiting for each pass does: the parts are the whole.
TEST_F(Pictures, passes_that_are_waited_for_make_up_the_picture) {
    DrawOptions options;
    EXPECT_FALSE(draw(options).passes_waited);
    options.time_passes = true;
    draw(options);
    const FrameReport report = draw(options);
    EXPECT_TRUE(report.passes_waited);
    ASSERT_FALSE(report.passes.empty());
    double sum = 0;
    for (const PassTime& pass : report.passes) sum += pass.ms;
    EXPECT_DOUBLE_EQ(report.gpu_ms, sum);
    EXPECT_LT(sum, took_ms_);
    EXPECT_GT(sum, 0.5 * took_ms_);
    const auto longest = std::max_element(report.passes.begin(), report.passes.end(),
                                          [](const auto& a, const auto& b) { return a.ms < b.ms; });
    EXPECT_STREQ(longest->name, "sea");
    // Back to timestamps, which come some pictures later.
    options.time_passes = false;
    for (int i = 0; i < 6; ++i) draw(options);
    EXPECT_FALSE(draw(options).passes_waited);
}

/// A lean picture has fewer triangles and looks alike; what was full before is full again, to the bit.
TEST_F(Pictures, lean_ones_look_alike_with_fewer_triangles) {
    DrawOptions options;
    const FrameReport full = draw(options);
    const Picture before = target_.read();
    options.lean = true;
    const FrameReport lean = draw(options);
    const Picture picture = target_.read();
    EXPECT_LT(lean.sea_triangles, full.sea_triangles * 2 / 3);
    EXPECT_GT(lean.sea_triangles, full.sea_triangles / 6);
    double sum = 0;
    double colour[2][3] = {};
    for (size_t i = 0; i < picture.rgb.size(); ++i) {
        sum += std::abs(int{picture.rgb[i]} - int{before.rgb[i]});
        colour[0][i % 3] += before.rgb[i];
        colour[1][i % 3] += picture.rgb[i];
    }
    const auto bytes = static_cast<double>(picture.rgb.size());
    EXPECT_LT(sum / bytes, 12.0);
    EXPECT_GT(sum / bytes, 0.01);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(colour[0][c] / colour[1][c], 1.0, 0.02) << "channel " << c;
    options.lean = false;
    draw(options);
    EXPECT_TRUE(target_.read() == before);
}

}  // namespace
}  // namespace trochoid
