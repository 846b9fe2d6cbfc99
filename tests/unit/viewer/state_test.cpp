// What the keys change, without a window.
#include "client/app/viewer_state.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "client/app/sea_clock_choice.hpp"

namespace trochoid {
namespace {

std::string pressed(ViewerState& state, Action action, size_t layer = 0) {
    std::string notice;
    EXPECT_TRUE(state.press({action, layer}, notice));
    return notice;
}

TEST(ViewerState, goes_round_through_every_choice) {
    ViewerState state{ViewerOptions{}};
    std::set<MesherKind> meshers;
    for (int i = 0; i < 4; ++i) {
        pressed(state, Action::next_mesher);
        meshers.insert(state.wanted().mesher);
    }
    EXPECT_EQ(meshers.size(), 4U);
    EXPECT_EQ(state.wanted().mesher, MesherKind::patches);
    EXPECT_EQ(pressed(state, Action::next_mesher), "Mesher uniform");
    for (int i = 0; i < 3; ++i) pressed(state, Action::next_displacement);
    for (int i = 0; i < 3; ++i) pressed(state, Action::next_far_method);
    for (int i = 0; i < 3; ++i) pressed(state, Action::next_refinement);
    for (int i = 0; i < 3; ++i) pressed(state, Action::next_quality);
    DrawOptions expected = options_for(Quality::medium);
    expected.mesher = MesherKind::uniform;
    EXPECT_EQ(state.wanted(), expected);
}

TEST(ViewerState, a_culling_camera_out_of_reach_follows_again) {
    ViewerState state{ViewerOptions{}};
    pressed(state, Action::freeze);
    const auto jumped_to = [&](double x_m) {
        Camera far = state.fly().camera();
        far.position.x = to_lattice(x_m);
        state.fly().go_to(far);
        std::string notice;
        state.keep_in_reach(notice);
        return notice;
    };
    EXPECT_EQ(jumped_to(200'000), "");
    ASSERT_TRUE(state.frozen());
    EXPECT_LE(std::abs(frame_of(*state.frozen(), DepthRange::classic,
                                frame_of(state.fly().camera(), DepthRange::classic).anchor)
                           .cell.x),
              int64_t{1} << 29);
    // Beyond 2097 km its place did not fit the 32 bits of shaders any more.
    EXPECT_NE(jumped_to(2'500'000).find("2500 km behind"), std::string::npos);
    EXPECT_FALSE(state.frozen());
    EXPECT_EQ(jumped_to(-2'500'000), "");
}

TEST(ViewerState, light_goes_round_the_clock) {
    ViewerOptions options;
    options.draw.hour = 23.9;
    ViewerState state(options);
    EXPECT_EQ(pressed(state, Action::later), "Light of 00:09");
    EXPECT_EQ(pressed(state, Action::earlier), "Light of 23:54");
    EXPECT_GE(state.wanted().hour, 0);
    EXPECT_LT(state.wanted().hour, 24);
}

TEST(ViewerState, birds_eye_shows_boxes_and_leaves_them_as_they_were) {
    ViewerState state{ViewerOptions{}};
    pressed(state, Action::birds_eye);
    EXPECT_TRUE(state.wanted().boxes);
    EXPECT_TRUE(state.fly().birds_eye());
    pressed(state, Action::birds_eye);
    EXPECT_FALSE(state.wanted().boxes);
    pressed(state, Action::boxes);
    pressed(state, Action::birds_eye);
    pressed(state, Action::birds_eye);
    EXPECT_TRUE(state.wanted().boxes);
}

TEST(ViewerState, starts_as_asked) {
    ViewerOptions options;
    options.freeze = options.birds_eye = true;
    options.target_ms = 20;
    const ViewerState state(options);
    ASSERT_TRUE(state.frozen());
    EXPECT_DOUBLE_EQ(state.frozen()->altitude_m, options.camera.altitude_m) << "frozen before it rose";
    EXPECT_TRUE(state.fly().birds_eye());
    EXPECT_DOUBLE_EQ(state.target_ms(), 20);
}

TEST(ViewerState, freezes_switches_layers_and_leaves_files_to_others) {
    ViewerState state{ViewerOptions{}};
    pressed(state, Action::freeze);
    EXPECT_TRUE(state.frozen());
    pressed(state, Action::freeze);
    EXPECT_FALSE(state.frozen());
    EXPECT_EQ(pressed(state, Action::layer, 1), "shadow and shoaling by land off");
    EXPECT_FALSE(state.wanted().layers.has(Layer::shelter));
    std::string notice;
    for (const Action action : {Action::close, Action::full_screen, Action::picture, Action::record})
        EXPECT_FALSE(state.press({action, 0}, notice));
}

TEST(ViewerState, holds_a_target_and_tells_the_server_in_steps) {
    ViewerOptions options;
    options.target_ms = 10;
    ViewerState state(options);
    EXPECT_FLOAT_EQ(state.error_for_server(), options.draw.error_px);
    std::set<float> told;
    std::set<float> drawn;
    for (int i = 0; i < 400; ++i) {
        const double error = static_cast<double>(state.in_force().error_px);
        state.took(2 + 30 * 36 / (error * error));
        told.insert(state.error_for_server());
        drawn.insert(state.in_force().error_px);
        EXPECT_LE(state.error_for_server(), state.in_force().error_px * 1.001F)
            << "never less than what is drawn needs";
    }
    EXPECT_GT(drawn.size(), 2U);
    EXPECT_LE(told.size(), 6U);
    EXPECT_GT(state.in_force().error_px, options.draw.error_px);
    pressed(state, Action::budget);
    EXPECT_EQ(state.in_force(), state.wanted());
    EXPECT_EQ(pressed(state, Action::budget), "Holding 10.0 ms a frame") << "the target that was";
}

TEST(ViewerState, preset_keys_go_through_all_and_keep_the_size) {
    ViewerOptions options;
    options.camera.width = 333;
    ViewerState state(options);
    std::set<std::string> names;
    for (int i = 0; i < 5; ++i) {
        pressed(state, Action::next_preset);
        names.insert(state.preset());
    }
    EXPECT_EQ(names.size(), 5U);
    EXPECT_EQ(state.fly().camera().width, 333U);
}

TEST(ViewerState, preset_from_above_takes_the_boxes_of_the_birds_eye_along_no_longer) {
    ViewerState state{ViewerOptions{}};
    pressed(state, Action::birds_eye);
    EXPECT_TRUE(state.wanted().boxes);
    pressed(state, Action::next_preset);
    EXPECT_FALSE(state.fly().birds_eye());
    EXPECT_FALSE(state.wanted().boxes);
}

TEST(SeaClock, follows_holds_or_steps) {
    SeaClockChoice follows(std::nullopt, 0);
    follows.begin({5});
    EXPECT_FALSE(follows.time());
    EXPECT_FALSE(follows.repeatable());
    SeaClockChoice holds(2.5, 0);
    holds.begin({5});
    holds.advance();
    EXPECT_EQ(holds.time(), SeaTime{2'500'000});
    SeaClockChoice steps(2.0, 0.04);
    steps.advance();
    EXPECT_EQ(steps.time(), SeaTime{2'000'000}) << "nothing counts before it begins";
    steps.begin({99});
    for (int i = 0; i < 3; ++i) steps.advance();
    EXPECT_EQ(steps.time(), SeaTime{2'120'000});
    EXPECT_NEAR(steps.shown_s(), 0.12, 1e-12);
    SeaClockChoice from_now(std::nullopt, 0.5);
    EXPECT_FALSE(from_now.time());
    EXPECT_TRUE(from_now.repeatable());
    from_now.begin({7'000'000});
    from_now.advance();
    EXPECT_EQ(from_now.time(), SeaTime{7'500'000});
}

}  // namespace
}  // namespace trochoid
