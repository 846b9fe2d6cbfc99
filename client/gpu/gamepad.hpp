#pragma once
#include "client/scene/fly_camera.hpp"

namespace trochoid {

/// A gamepad's sticks and triggers, -1 to 1 each, as GLFW gives them (down and right positive; a trigger at rest is -1).
struct GamepadAxes {
    double left_x = 0;
    double left_y = 0;
    double right_x = 0;
    double right_y = 0;
    double left_trigger = -1;
    double right_trigger = -1;
    bool fast = false;
    bool operator==(const GamepadAxes&) const = default;
};

/// The left stick flies, the right one looks, the triggers go down and up. Sticks at rest are never quite at 0: a dead
/// zone of an eighth takes that off, and what is left grows as its square.
FlyInput fly_input_of(const GamepadAxes& axes);

/// Both at once, none beyond its range.
FlyInput together(const FlyInput& a, const FlyInput& b);

}  // namespace trochoid
