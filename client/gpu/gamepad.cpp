#include "client/gpu/gamepad.hpp"

#include <algorithm>
#include <cmath>

namespace trochoid {

namespace {

constexpr double dead_zone = 0.125;

struct Stick {
    double x = 0;
    double y = 0;
};

/// The dead zone is a disc, so that a stick pushed ahead does not lose its small deviation to the side in a step.
Stick shaped(double x, double y) {
    if (!std::isfinite(x) || !std::isfinite(y)) return {};
    const double length = std::hypot(x, y);
    if (length <= dead_zone) return {};
    const double pushed = (std::min(length, 1.0) - dead_zone) / (1.0 - dead_zone);
    const double share = pushed * pushed / length;
    return {x * share, y * share};
}

}  // namespace

FlyInput fly_input_of(const GamepadAxes& axes) {
    const Stick left = shaped(axes.left_x, axes.left_y);
    const Stick right = shaped(axes.right_x, axes.right_y);
    FlyInput input;
    input.right = left.x;
    input.ahead = -left.y;
    input.rotate_x = right.x;
    input.rotate_y = right.y;
    input.up = shaped((axes.right_trigger - axes.left_trigger) / 2.0, 0.0).x;
    input.fast = axes.fast;
    return input;
}

FlyInput together(const FlyInput& a, const FlyInput& b) {
    const auto sum = [](double x, double y) { return std::clamp(x + y, -1.0, 1.0); };
    FlyInput both = a;
    both.ahead = sum(a.ahead, b.ahead);
    both.right = sum(a.right, b.right);
    both.up = sum(a.up, b.up);
    both.rotate_x = sum(a.rotate_x, b.rotate_x);
    both.rotate_y = sum(a.rotate_y, b.rotate_y);
    both.turn_x += b.turn_x;
    both.turn_y += b.turn_y;
    both.pan_x += b.pan_x;
    both.pan_y += b.pan_y;
    both.wheel += b.wheel;
    both.fast = a.fast || b.fast;
    both.slow = a.slow || b.slow;
    return both;
}

}  // namespace trochoid
