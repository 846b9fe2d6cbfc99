// The picture's light, foam and far sea: what can be told of them by numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "client/gpu/far_sea_pass.hpp"
#include "client/gpu/offscreen_context.hpp"
#include "client/gpu/renderer.hpp"
#include "client/scene/presets.hpp"
#include "tests/gpu/foam_coverage.hpp"
#include "tests/gpu/weather_sea.hpp"

namespace trochoid {
namespace {

constexpr uint32_t width = 320;
constexpr uint32_t height = 180;

Camera looking(double altitude, double yaw_degrees, double pitch_degrees) {
    Camera camera;
    camera.position = {to_lattice(300.5), to_lattice(-211.25)};
    camera.altitude_m = altitude;
    camera.yaw = yaw_degrees / 57.29577951;
    camera.pitch = pitch_degrees / 57.29577951;
    camera.width = width;
    camera.height = height;
    return camera;
}

/// Mean of the screen's green over rows of a picture, 0 to 255.
double mean_of_rows(const Picture& picture, uint32_t first, uint32_t last) {
    double sum = 0;
    for (size_t i = size_t{first} * picture.width; i < size_t{last} * picture.width; ++i)
        sum += picture.rgb[3 * i + 1];
    return sum / (static_cast<double>(last - first) * picture.width);
}

double mean_of(const Picture& picture) { return mean_of_rows(picture, 0, picture.height); }

/// Share of pixels that are nearly white and colourless: foam under a closed sky.
double white_share(const Picture& picture, uint32_t first_row, int least = 150) {
    size_t white = 0;
    for (size_t i = size_t{first_row} * picture.width; i < size_t{picture.height} * picture.width; ++i) {
        const auto* rgb = &picture.rgb[3 * i];
        if (std::min({rgb[0], rgb[1], rgb[2]}) > least) ++white;
    }
    return static_cast<double>(white) / (static_cast<double>(picture.height - first_row) * picture.width);
}

class Look : public testing::Test {
protected:
    static void SetUpTestSuite() { context_ = std::make_unique<OffscreenContext>(); }
    static void TearDownTestSuite() { context_.reset(); }
    static std::unique_ptr<OffscreenContext> context_;
};
std::unique_ptr<OffscreenContext> Look::context_;

/// A renderer with a sea of some weather, and a clock.
class Scene {
public:
    explicit Scene(const Weather& weather) : source_(TerrainGrid{}) { set_weather(source_, weather); }

    Picture draw(const Camera& camera, const DrawOptions& options, int64_t now_us) {
        ViewState view = view_of(camera, glm::dvec3(0));
        view.accepted_error_px = options.error_px;
        source_.set_view(view);
        source_.set_time(SeaTime{now_us});
        report_ = renderer_.draw(target_, source_.snapshot(), camera, camera, options);
        return target_.read();
    }
    const FrameReport& report() const { return report_; }
    FixtureSource& source() { return source_; }

private:
    FixtureSource source_;
    Renderer renderer_;
    RenderTarget target_{width, height, 1};
    FrameReport report_;
};

TEST_F(Look, light_follows_the_sun) {
    const SkyModel noon(12.0);
    const SkyModel evening(19.0);
    const SkyModel midnight(0.0);
    EXPECT_GT(noon.light().towards.z, 0.3F) << "on the northern half the sun is in the south at noon";
    EXPECT_GT(sun_direction(6.0, 0.87, 0.0).x, 0.9F) << "and rises in the east";
    EXPECT_GT(noon.light().irradiance.b / noon.light().irradiance.r, 0.7F);
    EXPECT_LT(evening.light().irradiance.b / evening.light().irradiance.r, 0.5F) << "the low sun is red";
    const glm::vec3 zenith = noon.radiance({0, 1, 0});
    EXPECT_GT(zenith.b, 1.5F * zenith.r) << "the sky is blue";
    EXPECT_GT(noon.radiance({0, 0.01F, -1}).g, zenith.g) << "and brighter at the horizon";
    EXPECT_LT(midnight.light().ambient.g, 0.02F * noon.light().ambient.g);
    EXPECT_GT(midnight.light().ambient.g, 0.0F);
}

TEST_F(Look, the_picture_is_dark_at_night_and_bright_by_day) {
    Scene scene(weather_named("breeze"));
    DrawOptions options;
    const Camera camera = looking(12, 250, -4);
    const auto brightness = [&](double hour) {
        options.hour = hour;
        return mean_of(scene.draw(camera, options, 60'000'000));
    };
    const double noon = brightness(12.0);
    const double dusk = brightness(20.3);
    const double night = brightness(0.0);
    EXPECT_GT(noon, 90);
    EXPECT_LT(dusk, 0.85 * noon);
    EXPECT_LT(night, 0.4 * noon);
    EXPECT_GT(night, 4) << "the moon shines";
}

TEST_F(Look, waves_tell_the_wind) {
    // Fully developed seas after Pierson and Moskowitz: Hs = 0.21 U^2 / g, peak at 0.88 g / U of the wind at 19.5 m.
    for (const float wind : {6.0F, 10.0F, 15.0F, 20.0F}) {
        const float height_m = 0.21F * wind * wind / 9.81F;
        const float energy_period = 0.857F * 6.2832F * wind / (0.88F * 9.81F);
        EXPECT_NEAR(wind_of(height_m, energy_period), 0.93F * wind, 0.15F * wind) << wind;
    }
    EXPECT_LT(wind_of(0.9F, 10.0F), 2.0F) << "a low long swell is no wind";
    EXPECT_EQ(wind_of(0.0F, 5.0F), 0.0F);
    EXPECT_EQ(scroll_speed(3.0F), 0.0F);
    EXPECT_NEAR(scroll_speed(12.25F), 4.0F, 1e-3F) << "A (log_a(a^2) - 1) = A";
    for (float wind = 3.0F; wind < 20.0F; wind += 0.05F)
        EXPECT_LT(scroll_speed(wind + 0.05F) - scroll_speed(wind), 0.12F) << wind;
    EXPECT_NEAR(normal_quantile(0.025F), 1.96F, 1e-3F);
    EXPECT_NEAR(whitecap_share(10.0F), 0.0099F, 3e-4F);
    EXPECT_EQ(whitecap_share(2.9F), 0.0F);  // light air breaks nothing
}

/// Slopes displayed, mapped and left to roughness sum up to the same near and far, so the sea's mean brightness has no step.
TEST_F(Look, near_passes_into_far_without_a_ring) {
    Scene scene(weather_named("breeze"));
    DrawOptions options;
    options.hour = 12.0;
    // From above, away from the sun: rows are rings about the camera.
    const Picture picture = scene.draw(looking(700, 0, -24), options, 60'000'000);
    std::vector<double> rows;
    for (uint32_t row = 30; row + 3 <= height; row += 3) rows.push_back(mean_of_rows(picture, row, row + 3));
    for (size_t i = 1; i < rows.size(); ++i)
        EXPECT_NEAR(rows[i], rows[i - 1], 6.0) << "between rows " << 27 + 3 * i << " and " << 30 + 3 * i;
}

TEST_F(Look, far_methods_differ) {
    Scene scene(weather_named("gale"));
    const Camera camera = looking(9, 40, -12);
    DrawOptions options;
    options.far_method = FarMethod::texture;
    const Picture texture = scene.draw(camera, options, 60'000'000);
    // Nothing of the waves is evaluated: another phase of all trains leaves the picture as it is.
    Weather other = weather_named("gale");
    Scene shifted(other);
    WaveTrainBox box = *shifted.source().state().boxes.at({1});
    for (WaveTrain& train : box.trains) train.phase += 0x5b000000U;
    shifted.source().add_box(box);
    EXPECT_EQ(shifted.draw(camera, options, 60'000'000), texture);
    options.far_method = FarMethod::spectrum;
    const Picture spectrum = scene.draw(camera, options, 60'000'000);
    EXPECT_NE(shifted.draw(camera, options, 60'000'000), spectrum);
    options.far_method = FarMethod::combined;
    EXPECT_NE(scene.draw(camera, options, 60'000'000), spectrum);
}

TEST_F(Look, glitter_keeps_its_brightness_from_frame_to_frame) {
    Scene scene(weather_named("breeze"));
    DrawOptions options;
    options.hour = 17.5;
    options.foam_history = false;
    const SkyModel sky(17.5);
    const double towards = std::atan2(sky.light().towards.x, -sky.light().towards.z) * 57.29577951;
    const Camera camera = looking(40, towards, -6);
    std::vector<double> near;
    std::vector<double> far;
    for (int i = 0; i < 6; ++i) {
        const Picture picture = scene.draw(camera, options, 60'000'000 + i * 50'000);
        far.push_back(mean_of_rows(picture, 75, 95));
        near.push_back(mean_of_rows(picture, 130, 170));
    }
    for (size_t i = 1; i < near.size(); ++i) {
        EXPECT_NEAR(far[i], far[i - 1], 1.5);
        EXPECT_NEAR(near[i], near[i - 1], 5.0);
    }
}

TEST_F(Look, foam_stays_behind_the_crest_and_fades) {
    Scene scene(weather_named("storm"));
    DrawOptions options;
    options.spray = false;
    options.far_sea = false;
    const Camera camera = looking(45, 20, -50);
    const auto share_after = [&](bool history) {
        options.foam_history = history;
        double sum = 0;
        int counted = 0;
        for (int i = 0; i < 60; ++i) {
            const Picture picture = scene.draw(camera, options, 60'000'000 + i * 200'000);
            if (i >= 40) sum += white_share(picture, 20), ++counted;
        }
        return sum / counted;
    };
    const double at_once = share_after(false);
    const double remembered = share_after(true);
    EXPECT_GT(remembered, 0.01);
    EXPECT_LT(remembered, 0.6);
    EXPECT_NE(remembered, at_once);
    // The sea calms down at once, which no sea does; the foam that lies there is still seen, and gone half a minute later.
    Weather calm = weather_named("breeze");
    set_weather(scene.source(), calm);
    const double soon = white_share(scene.draw(camera, options, 72'100'000), 20, 120);
    double late = 1;
    for (int i = 0; i < 20; ++i)
        late = white_share(scene.draw(camera, options, 74'000'000 + i * 2'000'000), 20, 120);
    EXPECT_GT(soon, late + 0.005);
}

TEST_F(Look, foam_covers_what_the_wind_says) {
    for (const double wind : {5.0, 8.0, 12.0, 17.0, 25.0}) {
        FoamCoverage coverage(wind);
        ASSERT_NEAR(coverage.wind_m_s(), wind, 0.05 * wind);
        const double law = monahan_share(wind);
        // Near is the map's foam, far the noise's.
        const double near = coverage.mean(170, 4, 4.0);
        EXPECT_GT(near, 0.5 * law) << wind;
        EXPECT_LT(near, 2.0 * law) << wind;
        // Less than 0.2 % of a pixel is not drawn.
        if (wind < 8.0) continue;
        const double far = coverage.mean(1500, 1, 0.2);
        EXPECT_GT(far, 0.5 * law) << wind;
        EXPECT_LT(far, 2.0 * law) << wind;
    }
}

TEST_F(Look, foam_is_no_flat_white) {
    FoamCoverage storm(22.0);
    for (const double side : {24.0, 120.0}) {
        const FoamCoverage::Look look = storm.look(side, 13.0);
        std::vector<double> greens;
        double part = 0;
        for (size_t i = 0; i < look.share.size(); ++i) {
            if (look.share[i] > 0.5) greens.push_back(look.colours.rgb[3 * i + 1]);
            if (look.share[i] > 0.1 && look.share[i] < 0.7)
                part += 1.0 / static_cast<double>(look.share.size());
        }
        ASSERT_GT(greens.size(), size_t{1000}) << side;
        double mean = 0;
        for (const double g : greens) mean += g / static_cast<double>(greens.size());
        double squares = 0;
        for (const double g : greens) squares += (g - mean) * (g - mean) / static_cast<double>(greens.size());
        EXPECT_GT(std::sqrt(squares), 10.0) << side << " m: where there is foam it has lumps and hollows";
        EXPECT_GT(part, 0.02) << side << " m: and films";
        std::sort(greens.begin(), greens.end());
        EXPECT_GT(greens[greens.size() * 19 / 20], greens[greens.size() / 20] + 30) << "new foam and old";
    }
}

TEST_F(Look, dusk_is_orange_at_the_sun_and_blue_across) {
    for (const double hour : {19.2, 19.7, 20.2}) {
        const SkyModel dusk(hour);
        const glm::vec3 sun = dusk.light().true_sun;
        const glm::vec2 towards = glm::normalize(glm::vec2(sun.x, sun.z));
        const auto radiance = [&](float side, float rise) {
            const float level = std::sqrt(1.0F - rise * rise);
            return dusk.radiance({side * towards.x * level, rise, side * towards.y * level});
        };
        const glm::vec3 strip = radiance(1, 0.01F);
        EXPECT_GT(strip.r, strip.g) << hour;
        EXPECT_GT(strip.g, 0.9F * strip.b) << hour << ": orange, not pink";
        const glm::vec3 zenith = radiance(1, 0.98F);
        EXPECT_GT(zenith.b, 1.2F * zenith.g) << hour;
        EXPECT_GT(zenith.g, zenith.r) << hour << ": blue, not purple";
        const glm::vec3 across = radiance(-1, 0.3F);
        EXPECT_GT(across.b, across.r) << hour;
        EXPECT_GT(across.g, 0.9F * across.r) << hour;
        EXPECT_LT(dusk.light().ambient.r, dusk.light().ambient.g) << hour;
    }
}

TEST_F(Look, the_same_sea_times_give_the_same_picture) {
    DrawOptions options;
    const Camera camera = looking(10, 200, -8);
    const auto run = [&] {
        Scene scene(weather_named("storm"));
        Picture picture;
        for (const int64_t now : {60'000'000, 60'130'000, 60'420'000, 61'000'000, 61'900'000, 62'000'000})
            picture = scene.draw(camera, options, now);
        return picture;
    };
    EXPECT_EQ(run(), run());
}

TEST_F(Look, only_storms_throw_spray) {
    const Camera camera = looking(7, 225, -3);
    const auto differs = [&](const char* weather) {
        Scene with(weather_named(weather));
        Scene without(weather_named(weather));
        DrawOptions options;
        DrawOptions dry;
        dry.spray = false;
        bool any = false;
        for (int i = 0; i < 12; ++i) {
            const int64_t now = 60'000'000 + i * 250'000;
            any = with.draw(camera, options, now) != without.draw(camera, dry, now) || any;
        }
        return any;
    };
    EXPECT_TRUE(differs("storm"));
    EXPECT_FALSE(differs("breeze"));
}

TEST_F(Look, the_far_fan_holds_what_the_camera_sees) {
    for (const double pitch : {-1.2, -0.7, -0.2, 0.0, 0.3})
        for (const double altitude : {2.0, 300.0, 3'000.0}) {
            Camera camera = looking(altitude, 77, pitch * 57.29577951);
            const glm::vec3 fan = seen_fan(camera);
            const double up = std::tan(camera.vertical_angle / 2);
            const double side = up * width / height;
            for (const double y : {-1.0, -0.5, 0.0, 0.5, 1.0})
                for (const double x : {-1.0, -0.3, 0.6, 1.0}) {
                    // Right, up and forward of the picture, turned by the pitch.
                    const double ahead = std::cos(pitch) - y * up * std::sin(pitch);
                    const double rise = std::sin(pitch) + y * up * std::cos(pitch);
                    if (rise >= -1e-3) continue;
                    const double across = x * side;
                    const double distance = altitude * std::hypot(ahead, across) / -rise;
                    const double yaw = camera.yaw + std::atan2(across, ahead);
                    const double from_left = std::remainder(yaw - fan.x - fan.y / 2.0, 6.283185307179586);
                    EXPECT_LE(std::abs(from_left), fan.y / 2.0 + 1e-6) << pitch << " " << x << " " << y;
                    EXPECT_GE(distance, fan.z) << pitch << " " << altitude << " " << x << " " << y;
                }
        }
}

TEST_F(Look, presets_are_whole) {
    EXPECT_EQ(presets().size(), 5U);
    for (const Preset& preset : presets()) {
        Camera camera;
        DrawOptions options;
        apply(preset, camera, options);
        EXPECT_EQ(options.hour, preset.hour);
        EXPECT_DOUBLE_EQ(camera.altitude_m, preset.camera[1]);
        EXPECT_EQ(preset_named(preset.name)->scene, preset.scene);
    }
    EXPECT_FALSE(preset_named("doldrums"));
}

}  // namespace
}  // namespace trochoid
