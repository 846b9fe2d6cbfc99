// Keys, sticks and the camera that they move.
#include <gtest/gtest.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cmath>
#include <set>

#include "client/gpu/gamepad.hpp"
#include "client/gpu/key_bindings.hpp"
#include "client/scene/fly_camera.hpp"

namespace trochoid {
namespace {

TEST(Keys, ask_for_what_the_help_says) {
    EXPECT_EQ(key_press_of(GLFW_KEY_F1, GLFW_PRESS, 0)->action, Action::overlay);
    EXPECT_EQ(key_press_of(GLFW_KEY_F7, GLFW_PRESS, 0)->action, Action::freeze);
    EXPECT_EQ(key_press_of(GLFW_KEY_F8, GLFW_PRESS, 0)->action, Action::timers);
    EXPECT_EQ(key_press_of(GLFW_KEY_F11, GLFW_PRESS, 0)->action, Action::full_screen);
    EXPECT_EQ(key_press_of(GLFW_KEY_F12, GLFW_PRESS, 0)->action, Action::help);
    EXPECT_EQ(key_press_of(GLFW_KEY_H, GLFW_PRESS, GLFW_MOD_SHIFT)->action, Action::help)
        << "one may fly fast meanwhile";
    EXPECT_EQ(key_press_of(GLFW_KEY_ENTER, GLFW_PRESS, GLFW_MOD_ALT)->action, Action::full_screen);
    EXPECT_FALSE(key_press_of(GLFW_KEY_ENTER, GLFW_PRESS, 0));
    EXPECT_FALSE(key_press_of(GLFW_KEY_M, GLFW_PRESS, GLFW_MOD_ALT));
    EXPECT_FALSE(key_press_of(GLFW_KEY_M, GLFW_PRESS, GLFW_MOD_SUPER));
    EXPECT_FALSE(key_press_of(GLFW_KEY_W, GLFW_PRESS, 0)) << "flying is held, not pressed";
    for (int digit = 1; digit <= 9; ++digit)
        EXPECT_EQ(key_press_of(GLFW_KEY_0 + digit, GLFW_PRESS, 0),
                  (KeyPress{Action::layer, static_cast<size_t>(digit - 1)}));
    EXPECT_FALSE(key_press_of(GLFW_KEY_0, GLFW_PRESS, 0));
}

TEST(Keys, only_the_hour_goes_on_while_held) {
    EXPECT_EQ(key_press_of(GLFW_KEY_COMMA, GLFW_REPEAT, 0)->action, Action::earlier);
    EXPECT_EQ(key_press_of(GLFW_KEY_PERIOD, GLFW_REPEAT, 0)->action, Action::later);
    EXPECT_FALSE(key_press_of(GLFW_KEY_F11, GLFW_REPEAT, 0));
    EXPECT_FALSE(key_press_of(GLFW_KEY_1, GLFW_REPEAT, 0));
    EXPECT_FALSE(key_press_of(GLFW_KEY_F1, GLFW_RELEASE, 0));
}

TEST(Keys, are_each_bound_once_and_shown) {
    std::set<std::pair<int, bool>> keys;
    std::set<Action> shown;
    for (const KeyBinding& b : key_bindings()) {
        EXPECT_TRUE(keys.insert({b.key, b.with_alt}).second) << "key " << b.key << " is bound twice";
        if (!b.shown.empty()) {
            shown.insert(b.action);
            EXPECT_FALSE(b.about.empty());
        }
        // What flies cannot do anything else.
        for (const int flying : {GLFW_KEY_W, GLFW_KEY_A, GLFW_KEY_S, GLFW_KEY_D, GLFW_KEY_Q, GLFW_KEY_E})
            EXPECT_NE(b.key, flying);
    }
    for (int action = 0; action <= static_cast<int>(Action::layer); ++action) {
        EXPECT_TRUE(shown.contains(static_cast<Action>(action))) << "no key shown for action " << action;
        EXPECT_FALSE(keys_shown(static_cast<Action>(action)).empty());
    }
}

TEST(Gamepad, at_rest_does_nothing) {
    EXPECT_EQ(fly_input_of({}), FlyInput{});
    EXPECT_EQ(fly_input_of({0.08, -0.08, 0.05, 0.11, -0.98, -1.0, false}), FlyInput{})
        << "sticks rest near 0";
    EXPECT_EQ(fly_input_of({std::nan(""), 0, 0, 0, -1, -1, false}), FlyInput{});
}

TEST(Gamepad, sticks_fly_and_look) {
    const FlyInput ahead = fly_input_of({0, -1, 0, 0, -1, -1, true});
    EXPECT_DOUBLE_EQ(ahead.ahead, 1);
    EXPECT_TRUE(ahead.fast);
    EXPECT_DOUBLE_EQ(fly_input_of({1, 0, 0, 0, -1, -1, false}).right, 1);
    EXPECT_DOUBLE_EQ(fly_input_of({0, 0, 1, 0, -1, -1, false}).rotate_x, 1);
    EXPECT_DOUBLE_EQ(fly_input_of({0, 0, 0, 1, -1, -1, false}).rotate_y, 1);
    EXPECT_DOUBLE_EQ(fly_input_of({0, 0, 0, 0, -1, 1, false}).up, 1);
    EXPECT_DOUBLE_EQ(fly_input_of({0, 0, 0, 0, 1, -1, false}).up, -1);
    EXPECT_EQ(fly_input_of({0, 0, 0, 0, 1, 1, false}).up, 0) << "both triggers hold each other";
    // No step at the edge of the dead zone, and no more than all in a corner.
    EXPECT_LT(fly_input_of({0.13, 0, 0, 0, -1, -1, false}).right, 0.001);
    const FlyInput corner = fly_input_of({1, -1, 0, 0, -1, -1, false});
    EXPECT_LE(std::hypot(corner.right, corner.ahead), 1.0 + 1e-9);
    EXPECT_DOUBLE_EQ(together(ahead, ahead).ahead, 1);
}

Camera start() {
    Camera camera;
    camera.altitude_m = 30;
    camera.pitch = -0.1;
    return camera;
}

TEST(FlyCamera, flies_looks_and_changes_speed) {
    FlyCamera fly(start());
    FlyInput input;
    input.ahead = 1;
    fly.fly(input, 1.0);
    EXPECT_LT(fly.camera().position.z, 0) << "north is -z";
    EXPECT_NEAR(std::sqrt(glm::dot(fly.velocity(), fly.velocity())), fly.speed(), 1e-9);
    FlyInput slow = input;
    slow.slow = true;
    fly.fly(slow, 0.1);
    EXPECT_NEAR(std::sqrt(glm::dot(fly.velocity(), fly.velocity())), fly.speed() / 5, 1e-9);
    const double before = fly.speed();
    FlyInput wheel;
    wheel.wheel = 1;
    fly.fly(wheel, 0.0);
    EXPECT_DOUBLE_EQ(fly.speed(), before * 1.25);
    FlyInput look;
    look.turn_x = 100;
    look.rotate_y = 1;
    fly.fly(look, 0.1);
    EXPECT_GT(fly.camera().yaw, 0);
    EXPECT_LT(fly.camera().pitch, -0.1);
}

TEST(FlyCamera, drags_the_picture_with_the_mouse) {
    FlyCamera fly(start());
    FlyInput drag;
    drag.pan_x = 50;
    drag.pan_y = 20;
    fly.fly(drag, 0.0);
    EXPECT_LT(fly.camera().position.x, 0) << "dragged to the right, the camera goes left";
    EXPECT_GT(fly.camera().altitude_m, 30);
}

TEST(FlyCamera, looks_down_like_a_bird_and_comes_back) {
    FlyCamera fly(start());
    fly.set_birds_eye(true);
    EXPECT_TRUE(fly.birds_eye());
    EXPECT_GE(fly.camera().altitude_m, 1500);
    EXPECT_LT(fly.camera().pitch, -1.5);
    EXPECT_EQ(fly.camera().position, start().position);
    FlyInput ahead;
    ahead.ahead = 1;
    fly.fly(ahead, 1.0);
    EXPECT_LT(fly.camera().position.z, -to_lattice(100)) << "ahead is over the ground";
    const double high = fly.camera().altitude_m;
    FlyInput look;
    look.turn_y = 500;
    look.wheel = -1;
    fly.fly(look, 0.1);
    EXPECT_LT(fly.camera().pitch, -1.5) << "a bird's eye looks down";
    EXPECT_GT(fly.camera().altitude_m, high);
    // Higher than any other camera, and not held to their heights by flying on.
    look = {};
    look.wheel = -100;
    fly.fly(look, 0.1);
    fly.fly(ahead, 0.1);
    EXPECT_DOUBLE_EQ(fly.camera().altitude_m, 60'000);
    const LatticePoint there = fly.camera().position;
    fly.set_birds_eye(false);
    EXPECT_DOUBLE_EQ(fly.camera().altitude_m, 30);
    EXPECT_DOUBLE_EQ(fly.camera().pitch, -0.1);
    EXPECT_EQ(fly.camera().position, there) << "comes down where it has flown to";
}

}  // namespace
}  // namespace trochoid
