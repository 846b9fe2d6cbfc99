// The viewer's loop over a fixture: its pictures show sky, sea and land, and the sea moves.
#include <gtest/gtest.h>
#include <png.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "client/app/viewer_loop.hpp"
#include "client/gpu/graphics_error.hpp"
#include "client/gpu/offscreen_context.hpp"
#include "client/gpu/picture_file.hpp"
#include "client/gpu/render_target.hpp"
#include "client/gpu/shader_program.hpp"
#include "protocol/units/operator_error.hpp"
#include "tests/gpu/fixture_sea.hpp"

namespace trochoid {
namespace {

/// A sea whose time goes on by 0.4 s a frame: enough to be seen in the next, however few a busy machine draws.
class TickingFixture : public FixtureSource {
public:
    using FixtureSource::FixtureSource;
    SceneInput snapshot() override {
        set_time(sea_time_now() + 400'000);
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
    ViewerOptions options = small_run();
    options.fixed_step_s = 0.1;  // as many pictures on a busy machine
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
    options.panels = {true, true, false};
    options.draw.boxes = options.draw.rays = options.draw.patches = options.draw.fields =
        options.draw.wireframe = true;
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

std::vector<uint8_t> bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// A folder that goes with the test.
class Folder {
public:
    explicit Folder(const char* name) : path(temporary(name)) { std::filesystem::remove_all(path); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() { std::filesystem::remove_all(path); }
    std::filesystem::path path;
};

ViewerOptions recording_to(const Folder& folder) {
    ViewerOptions options = small_run();
    options.camera.width = 160;
    options.camera.height = 90;
    options.picture.clear();
    options.second_picture.clear();
    options.summary_json.clear();
    options.seconds = 0;
    options.record = folder.path.string();
    return options;
}

TEST(ViewerRecording, with_a_fixed_step_is_the_same_on_every_run) {
    const Folder first("trochoid-test-record-one");
    const Folder second("trochoid-test-record-two");
    for (const Folder* folder : {&first, &second}) {
        ViewerOptions options = recording_to(*folder);
        options.at_s = 61.5;
        options.fixed_step_s = 0.125;
        options.frames = 6;
        // Its own clock runs on with every look at it, and must not show.
        TickingFixture source(shipped_terrain());
        const ViewerSummary summary = run_viewer(source, options, [] { return false; });
        EXPECT_EQ(summary.recorded_pictures, 6U);
        EXPECT_EQ(summary.sea_time.us, 61'500'000 + 5 * 125'000);
    }
    for (int i = 0; i < 6; ++i) {
        const auto name = "frame_00000" + std::to_string(i) + ".png";
        const auto one = bytes_of(first.path / name);
        ASSERT_GT(one.size(), 1000U) << name;
        EXPECT_EQ(one, bytes_of(second.path / name)) << name;
        if (i > 0) {
            EXPECT_NE(one, bytes_of(first.path / "frame_000000.png")) << "the sea stands still";
        }
    }
    EXPECT_FALSE(std::filesystem::exists(first.path / "frame_000006.png"));
}

TEST(ViewerRecording, seconds_of_a_fixed_step_are_of_sea_time) {
    const Folder folder("trochoid-test-record-seconds");
    ViewerOptions options = recording_to(folder);
    options.fixed_step_s = 0.25;
    options.seconds = 1.0;
    TickingFixture source(TerrainGrid{});
    EXPECT_EQ(run_viewer(source, options, [] { return false; }).recorded_pictures, 4U);
}

TEST(ViewerRecording, never_writes_over_files) {
    const Folder folder("trochoid-test-record-full");
    std::filesystem::create_directories(folder.path);
    std::ofstream(folder.path / "mine.txt") << "precious";
    TickingFixture source(TerrainGrid{});
    try {
        run_viewer(source, recording_to(folder), [] { return false; });
        FAIL() << "it recorded among other files";
    } catch (const OperatorError& error) {
        EXPECT_NE(std::string(error.what()).find("not empty"), std::string::npos);
    }
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path), {}), 1);
}

TEST(ViewerTime, at_holds_the_sea_still) {
    ViewerOptions options = small_run();
    options.at_s = 75.0;
    TickingFixture source(TerrainGrid{});
    const ViewerSummary summary = run_viewer(source, options, [] { return false; });
    EXPECT_EQ(summary.sea_time.us, 75'000'000);
    EXPECT_EQ(read_png(options.picture).rgb, read_png(options.second_picture).rgb);
}

/// A sea that is known up to a moment only.
class UnknownFuture : public FixtureSource {
public:
    using FixtureSource::FixtureSource;
    SceneInput snapshot() override {
        SceneInput input = FixtureSource::snapshot();
        input.statistics.known_until = sea_time_now();
        return input;
    }
};

TEST(ViewerTime, waits_for_a_time_to_come_and_says_so) {
    ViewerOptions options = small_run();
    options.at_s = 70.0;
    options.patience_s = 1.2;
    UnknownFuture source(TerrainGrid{});
    try {
        run_viewer(source, options, [] { return false; });
        FAIL() << "it drew a sea that nobody knows yet";
    } catch (const OperatorError& error) {
        EXPECT_NE(std::string(error.what()).find("10.0 s ahead"), std::string::npos) << error.what();
    }
}

/// Sea time runs at most 16 times as fast as real time.
TEST(ViewerTime, refuses_at_once_what_no_patience_sees) {
    ViewerOptions options = small_run();
    options.at_s = 1e12;
    options.patience_s = 60;
    UnknownFuture source(TerrainGrid{});
    const auto start = std::chrono::steady_clock::now();
    std::string said = "it drew a sea that never comes";
    try {
        run_viewer(source, options, [] { return false; });
    } catch (const OperatorError& error) {
        said = error.what();
    }
    EXPECT_NE(said.find("the sea is at 60.000 s"), std::string::npos) << said;
    EXPECT_NE(said.find("to 1020.000 s at most"), std::string::npos) << said;
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
}

/// Between the lines there is no water: neither patches nor the far sea below them.
TEST(Viewer, a_wireframe_is_seen) {
    ViewerOptions options = small_run();
    options.camera.yaw = 0.0;
    options.at_s = 60.0;
    options.second_picture.clear();
    const auto light = [&](bool wireframe) {
        options.draw.wireframe = wireframe;
        TickingFixture source(TerrainGrid{});
        run_viewer(source, options, [] { return false; });
        return mean_of(read_png(options.picture), 0.1, 0.7, 0.9, 0.95);
    };
    const Mean water = light(false);
    const Mean lines = light(true);
    EXPECT_GT(lines.spread, water.spread + 15);
    EXPECT_GT(lines.red, water.red + 30);
}

/// A server that goes away after some looks.
class GoingSource : public FixtureSource {
public:
    using FixtureSource::FixtureSource;
    SceneInput snapshot() override {
        SceneInput input = FixtureSource::snapshot();
        if (++looks_ > 4) {
            input.statistics.connected = false;
            input.statistics.state = "server gone (refused), trying again in 2 s";
        }
        return input;
    }

private:
    int looks_ = 0;
};

TEST(ViewerServer, gone_ends_an_offscreen_run_with_an_error) {
    ViewerOptions options = small_run();
    options.seconds = 60;
    options.patience_s = 0.3;
    GoingSource source(TerrainGrid{});
    try {
        run_viewer(source, options, [] { return false; });
        FAIL() << "it went on for ever";
    } catch (const ServerGone& error) {
        EXPECT_NE(std::string(error.what()).find("server gone (refused)"), std::string::npos);
    }
    // Shorter than its patience: the pictures are there, and the end says that they are of an old sea.
    options.seconds = 0.3;
    options.patience_s = 30;
    std::filesystem::remove(options.picture);
    GoingSource again(TerrainGrid{});
    EXPECT_THROW(run_viewer(again, options, [] { return false; }), ServerGone);
    EXPECT_TRUE(std::filesystem::exists(options.picture));
}

TEST(ViewerBudget, an_unreachable_target_is_told_with_what_was_given_up) {
    ViewerOptions options = small_run();
    options.second_picture.clear();
    options.target_ms = 0.5;
    options.seconds = 0;
    options.frames = 60;
    options.camera.width = 96;
    options.camera.height = 54;
    TickingFixture source(TerrainGrid{});
    const ViewerSummary summary = run_viewer(source, options, [] { return false; });
    ASSERT_TRUE(summary.budget);
    EXPECT_GT(summary.budget->error_factor, 1.2);
    EXPECT_GT(summary.options.error_px, options.draw.error_px);
    std::ifstream file(options.summary_json);
    const nlohmann::json json = nlohmann::json::parse(file);
    EXPECT_EQ(json.at("budget").at("target_ms"), 0.5);
    EXPECT_EQ(json.at("budget").at("given_up").size(), summary.budget->given_up.size());
    EXPECT_GT(json.at("pass_ms").size(), 3U);
    EXPECT_GT(json.at("trains_at_camera").at("known"), 0);
}

TEST(ViewerView, from_above_shows_other_pictures_than_from_below) {
    ViewerOptions options = small_run();
    options.second_picture.clear();
    TickingFixture below(shipped_terrain());
    run_viewer(below, options, [] { return false; });
    const Picture plain = read_png(options.picture);
    options.birds_eye = options.freeze = true;
    TickingFixture above(shipped_terrain());
    run_viewer(above, options, [] { return false; });
    const Picture map = read_png(options.picture);
    // No sky, and land below all of a coast's right half.
    EXPECT_LT(mean_of(map, 0.1, 0.02, 0.3, 0.2).blue, mean_of(plain, 0.1, 0.02, 0.3, 0.2).blue - 15);
}

TEST(Picture, a_full_disk_is_noticed) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    Picture picture{64, 64, std::vector<uint8_t>(size_t{64} * 64 * 3, 7)};
    try {
        write_png("/dev/full", picture);
        FAIL() << "the picture is nowhere";
    } catch (const OperatorError& error) {
        EXPECT_NE(std::string(error.what()).find("No space left"), std::string::npos) << error.what();
    }
    EXPECT_TRUE(std::filesystem::exists("/dev/full"));
}

TEST(Shader, that_the_driver_refuses_is_told_with_driver_file_and_line) {
    const OffscreenContext context;
    try {
        const ShaderProgram program({"sky.vert", "sky.frag"}, {{"main nonsense ("}, {}});
        FAIL() << "the driver takes anything";
    } catch (const GraphicsError& error) {
        const std::string text = error.what();
        for (const char* part : {"sky.vert", "It says: ", "OpenGL 4", "LIBGL_ALWAYS_SOFTWARE"})
            EXPECT_NE(text.find(part), std::string::npos) << part << " is missing in:\n" << text;
    }
    EXPECT_EQ(GlHealth().check(), "") << "no OpenGL error is left over";
}

TEST(Target, beyond_what_the_device_draws_is_refused) {
    const OffscreenContext context;
    EXPECT_THROW(RenderTarget(1U << 20U, 16, 1), GraphicsError);
    EXPECT_NO_THROW(RenderTarget(64, 64, 64)) << "more samples than there are become as many as there are";
}

}  // namespace
}  // namespace trochoid
