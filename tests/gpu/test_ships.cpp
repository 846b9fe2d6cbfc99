// Ships in the picture: where they lie, and that they are left out where nobody wants them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "client/gpu/offscreen_context.hpp"
#include "client/gpu/renderer.hpp"
#include "server/world/ship_box.hpp"
#include "tests/gpu/fixture_sea.hpp"

namespace trochoid {
namespace {

constexpr uint32_t width = 320;
constexpr uint32_t height = 180;
constexpr SeaTime start{60'000'000};

class Ships : public testing::Test {
protected:
    static void SetUpTestSuite() { context_ = std::make_unique<OffscreenContext>(); }
    static void TearDownTestSuite() { context_.reset(); }
    static std::unique_ptr<OffscreenContext> context_;
};
std::unique_ptr<OffscreenContext> Ships::context_;

/// A freighter that crosses from left to right 150 m ahead of a camera that looks north.
Camera looking_north() {
    Camera camera;
    camera.position = {to_lattice(40.0), to_lattice(150.0)};
    camera.altitude_m = 12;
    camera.pitch = -0.08;
    camera.width = width;
    camera.height = height;
    return camera;
}

class Scene {
public:
    Scene() : source_(TerrainGrid{}) {
        StartShip ship;
        ship.towards_degrees = 90;
        ship.speed = 8;
        ship.length = 110;
        ship.at = {to_lattice(-280.0), 0};
        NewIds ids;
        ids.box = {70};
        ids.first_train = {7'000};
        source_.add_box(box_of(ship, start, ids).value());
    }
    Picture draw(const DrawOptions& options, double seconds) {
        const Camera camera = looking_north();
        ViewState view = view_of(camera, glm::dvec3(0));
        view.accepted_error_px = options.error_px;
        source_.set_view(view);
        source_.set_time({start.us + static_cast<int64_t>(seconds * 1e6)});
        report_ = renderer_.draw(target_, source_.snapshot(), camera, camera, options);
        return target_.read();
    }
    void add_box(const WaveTrainBox& box) { source_.add_box(box); }
    const FrameReport& report() const { return report_; }

private:
    FixtureSource source_;
    Renderer renderer_;
    RenderTarget target_{width, height, 1};
    FrameReport report_;
};

struct Found {
    int pixels = 0;
    uint32_t left = width, right = 0, top = height, bottom = 0;
};

/// Where two pictures differ clearly.
Found difference_of(const Picture& a, const Picture& b) {
    Found found;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const size_t at = 3 * (size_t{y} * width + x);
            int most = 0;
            for (size_t i = 0; i < 3; ++i)
                most = std::max(most, std::abs(int{a.rgb[at + i]} - int{b.rgb[at + i]}));
            if (most < 12) continue;
            ++found.pixels;
            found.left = std::min(found.left, x);
            found.right = std::max(found.right, x);
            found.top = std::min(found.top, y);
            found.bottom = std::max(found.bottom, y);
        }
    return found;
}

DrawOptions without_foam(bool ships) {
    DrawOptions options;
    options.foam_history = false;
    options.ships = ships;
    return options;
}

TEST_F(Ships, lies_where_the_wake_begins) {
    Scene scene;
    // After 40 s she is 40 m east: right ahead of the camera, 150 m off, 110 m long.
    const Found found =
        difference_of(scene.draw(without_foam(true), 40.0), scene.draw(without_foam(false), 40.0));
    const double focal = 0.5 * height / std::tan(0.45);
    const double half = 55.0 / 150.0 * focal;
    EXPECT_NEAR(found.left, width / 2.0 - half, 5);
    EXPECT_NEAR(found.right, width / 2.0 + half, 5);
    // The water's line lies 12 m below the eye.
    const double water = height / 2.0 + std::tan(std::atan(12.0 / 145.0) - 0.08) * focal;
    EXPECT_NEAR(found.bottom, water, 4);
    EXPECT_NEAR(found.top, water - 0.15 * 110.0 / 150.0 * focal, 8);
    EXPECT_GT(found.pixels, 700);
    // 10 s later she has moved 80 m to the right.
    const Found later =
        difference_of(scene.draw(without_foam(true), 50.0), scene.draw(without_foam(false), 50.0));
    EXPECT_NEAR(later.left - found.left, 80.0 / 150.0 * focal, 5);
}

TEST_F(Ships, one_that_has_stopped_is_drawn_where_she_lies) {
    Scene scene;
    WaveTrainBox course;
    {
        StartShip ship;
        ship.towards_degrees = 90;
        ship.speed = 8;
        ship.length = 60;
        NewIds ids;
        ids.box = {71};
        ids.first_train = {7'100};
        course = box_of(ship, start, ids).value();
        course.hull = {60.0F, 9.0F};
        // She stops 40 m east, right ahead of the camera.
        course.end = {start.us + 5'000'000};
        ids.box = {72};
        ids.first_train = {7'200};
        scene.add_box(course);
        scene.add_box(lying_box(course, course.end, ids));
    }
    const double half = 30.0 / 150.0 * 0.5 * height / std::tan(0.45);
    for (const double seconds : {100.0, 900.0}) {
        const Found found =
            difference_of(scene.draw(without_foam(true), seconds), scene.draw(without_foam(false), seconds));
        EXPECT_NEAR(found.left, width / 2.0 - half, 4) << seconds;
        EXPECT_NEAR(found.right, width / 2.0 + half, 4) << seconds;
        EXPECT_GT(found.pixels, 200) << seconds;
    }
}

TEST_F(Ships, are_gone_before_their_course_and_switched_off) {
    Scene scene;
    EXPECT_EQ(
        difference_of(scene.draw(without_foam(true), -1.0), scene.draw(without_foam(false), -1.0)).pixels, 0);
    const bool timed = std::any_of(scene.report().passes.begin(), scene.report().passes.end(),
                                   [](const PassTime& pass) { return pass.name == std::string("ships"); });
    EXPECT_TRUE(timed || scene.report().passes.empty());
}

TEST_F(Ships, the_same_sea_time_gives_the_same_picture) {
    Scene one;
    one.draw(without_foam(true), 20.0);
    const Picture first = one.draw(without_foam(true), 40.0);
    Scene other;
    EXPECT_EQ(other.draw(without_foam(true), 40.0), first);
}

}  // namespace
}  // namespace trochoid
