// The viewer's loop over a fixture: its pictures show sky, sea and land, and the sea moves.
#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "client/app/viewer_loop.hpp"
#include "client/gpu/render_target.hpp"
#include "protocol/units/operator_error.hpp"
#include "tests/gpu/fixture_sea.hpp"

namespace trochoid {
namespace {

/// A sea whose time goes on by 50 ms a frame.
class TickingFixture : public FixtureSource {
public:
    using FixtureSource::FixtureSource;
    SceneInput snapshot() override {
        set_time(sea_time_now() + 50'000);
        return FixtureSource::snapshot();
    }
};

/// A server that never answers.
class SilentSource : public SeaSource {
public:
    SceneInput snapshot() override {
        SceneInput input;
        input.statistics.state = "nobody there";
        return input;
    }
    void set_view(const ViewState& /*view*/) override {}
    SeaTime sea_time_now() override { return {}; }
    void request_rays(BoxId /*box*/) override {}
};

Picture read_png(const std::string& path) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    EXPECT_NE(png_image_begin_read_from_file(&image, path.c_str()), 0) << image.message;
    image.format = PNG_FORMAT_RGB;
    Picture picture{image.width, image.height, std::vector<uint8_t>(PNG_IMAGE_SIZE(image))};
    EXPECT_NE(png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr), 0);
    return picture;
}

struct Mean {
    double red = 0;
    double green = 0;
    double blue = 0;
    double spread = 0;  // standard deviation of green
};
Mean mean_of(const Picture& p, double x0, double y0, double x1, double y1) {
    Mean mean;
    double squares = 0;
    double count = 0;
    for (auto y = static_cast<uint32_t>(y0 * p.height); y < static_cast<uint32_t>(y1 * p.height); ++y)
        for (auto x = static_cast<uint32_t>(x0 * p.width); x < static_cast<uint32_t>(x1 * p.width); ++x) {
            const uint8_t* rgb = &p.rgb[(size_t{y} * p.width + x) * 3];
            mean.red += rgb[0];
            mean.green += rgb[1];
            mean.blue += rgb[2];
            squares += rgb[1] * rgb[1];
            ++count;
        }
    mean.red /= count;
    mean.green /= count;
    mean.blue /= count;
    mean.spread = std::sqrt(std::max(squares / count - mean.green * mean.green, 0.0));
    return mean;
}

std::string temporary(const char* name) { return (std::filesystem::temp_directory_path() / name).string(); }

ViewerOptions small_run() {
    ViewerOptions options;
    options.offscreen = true;
    options.seconds = 0.4;
    options.camera.width = 480;
    options.camera.height = 270;
    // As the pictures of the coast: sea on the left, beach and grass on the right, sky above.
    options.camera.position = {to_lattice(-500), to_lattice(-3'600)};
    options.camera.altitude_m = 40;
    options.camera.yaw = 200 * 0.0174532925;
    options.camera.pitch = -12 * 0.0174532925;
    options.picture = temporary("trochoid-test-first.png");
    options.second_picture = temporary("trochoid-test-second.png");
    options.second_picture_after = 0.3;
    options.summary_json = temporary("trochoid-test-summary.json");
    return options;
}

TEST(Viewer, pictures_show_sky_sea_and_land_and_the_sea_moves) {
    const ViewerOptions options = small_run();
    TickingFixture source(shipped_terrain());
    const ViewerSummary summary = run_viewer(source, options, [] { return false; });
    EXPECT_GT(summary.frames, 2U);
    EXPECT_GT(summary.last.patches_drawn, 10U);
    const Picture first = read_png(options.picture);
    const Picture second = read_png(options.second_picture);
    ASSERT_EQ(first.width, 480U);
    const Mean sky = mean_of(first, 0.1, 0.02, 0.9, 0.2);
    EXPECT_GT(sky.blue, sky.red + 15);
    EXPECT_GT(sky.blue, 150);
    const Mean sea = mean_of(first, 0.02, 0.6, 0.35, 0.95);
    EXPECT_GT(sea.blue, sea.red + 40);
    EXPECT_LT(sea.red, 110);
    EXPECT_GT(sea.spread, 3) << "waves make light and dark";
    const Mean land = mean_of(first, 0.72, 0.45, 0.98, 0.6);
    EXPECT_GT(land.green, land.blue + 15) << "grass and heath";
    size_t changed = 0;
    for (size_t i = 0; i < first.rgb.size(); ++i)
        if (std::abs(first.rgb[i] - second.rgb[i]) > 6) ++changed;
    EXPECT_GT(changed, first.rgb.size() / 50);
    // The land stands still.
    const Mean later = mean_of(second, 0.72, 0.45, 0.98, 0.6);
    EXPECT_NEAR(later.green, land.green, 0.5);
    for (size_t i = 0; i < first.rgb.size(); i += 3)
        ASSERT_GT(first.rgb[i] + first.rgb[i + 1] + first.rgb[i + 2], 20)
            << "a black pixel at " << i / 3 % 480 << ' ' << i / 3 / 480;

    std::ifstream file(options.summary_json);
    const nlohmann::json json = nlohmann::json::parse(file);
    EXPECT_EQ(json.at("wave_trains"), 32);
    EXPECT_EQ(json.at("viewer"), "exact");
    EXPECT_EQ(json.at("patches_known"), summary.last.patches_known);
    EXPECT_NE(summary_line(summary).find("32 wave trains"), std::string::npos);
}

TEST(Viewer, overlay_and_debug_views_draw_over_the_picture) {
    ViewerOptions options = small_run();
    options.second_picture.clear();
    TickingFixture plain(shipped_terrain());
    run_viewer(plain, options, [] { return false; });
    const Picture without = read_png(options.picture);
    options.overlay = true;
    options.debug.boxes = options.debug.rays = options.debug.patches = options.debug.fields =
        options.debug.wireframe = true;
    TickingFixture debugged(shipped_terrain());
    run_viewer(debugged, options, [] { return false; });
    const Picture with = read_png(options.picture);
    EXPECT_LT(mean_of(with, 0.03, 0.06, 0.2, 0.3).blue, mean_of(without, 0.03, 0.06, 0.2, 0.3).blue - 30)
        << "the overlay darkens its corner";
    EXPECT_NE(with.rgb, without.rgb);
}

TEST(Viewer, says_what_to_do_when_no_sea_comes) {
    ViewerOptions options = small_run();
    options.patience_s = 0.1;
    SilentSource source;
    try {
        run_viewer(source, options, [] { return false; });
        FAIL() << "it should have given up";
    } catch (const OperatorError& error) {
        EXPECT_NE(std::string(error.what()).find("nobody there"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("--connect"), std::string::npos);
    }
}

TEST(Viewer, ends_when_told_and_refuses_a_picture_it_cannot_write) {
    ViewerOptions options = small_run();
    options.seconds = 1e6;
    options.second_picture.clear();
    TickingFixture source(TerrainGrid{});
    int frames = 0;
    run_viewer(source, options, [&] { return ++frames > 5; });
    options.picture = "/nowhere/at/all.png";
    frames = 0;
    EXPECT_THROW(run_viewer(source, options, [&] { return ++frames > 5; }), OperatorError);
}

std::optional<ViewerOptions> parse(std::vector<const char*> words) {
    words.insert(words.begin(), "trochoid-viewer");
    return parse_viewer_options(static_cast<int>(words.size()), words.data());
}

TEST(ViewerOptions, read_places_sizes_and_debug_views) {
    const auto options = parse({"--camera=100.5,30,-2000,180,-5", "--size=640x360", "--debug=boxes,rays",
                                "--quality=low", "--offscreen"});
    ASSERT_TRUE(options);
    EXPECT_EQ(options->camera.position, (LatticePoint{to_lattice(100.5), to_lattice(-2'000)}));
    EXPECT_DOUBLE_EQ(options->camera.altitude_m, 30);
    EXPECT_EQ(options->camera.width, 640U);
    EXPECT_TRUE(options->debug.rays);
    EXPECT_FALSE(options->debug.patches);
    EXPECT_EQ(options->layers, displayed_layers);
    EXPECT_EQ(draw_options_of(*parse({"--layers=-noise,-round"})).layers,
              displayed_layers.without(Layer::noise).without(Layer::round));
    EXPECT_GT(draw_options_of(*options).error_px, DrawOptions{}.error_px);
    EXPECT_GT(options->seconds, 0);
}

TEST(ViewerOptions, refuse_what_makes_no_sense) {
    EXPECT_THROW(parse({"--camera=1,2,3"}), OperatorError);
    EXPECT_THROW(parse({"--camera=1e300,2,3,0,0"}), OperatorError);
    EXPECT_THROW(parse({"--camera=0,2,0,nan,0"}), OperatorError);
    EXPECT_THROW(parse({"--size=0x0"}), OperatorError);
    EXPECT_THROW(parse({"--size=640x360x2"}), OperatorError);
    EXPECT_THROW(parse({"--debug=everything"}), OperatorError);
    EXPECT_THROW(parse({"--quality=best"}), OperatorError);
    EXPECT_THROW(parse({"--layers=waves"}), OperatorError);
    EXPECT_THROW(parse({"--seconds=-1"}), OperatorError);
    EXPECT_THROW(parse({"--second-picture=x.png"}), OperatorError);
    EXPECT_THROW(parse({"--unheard-of"}), OperatorError);
}

}  // namespace
}  // namespace trochoid
