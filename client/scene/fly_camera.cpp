#include "client/scene/fly_camera.hpp"

#include <algorithm>
#include <cmath>

namespace trochoid {

namespace {

constexpr double turn_per_pixel = 0.0025;
constexpr double fastest_turn = 1.6;  // rad/s
constexpr double steepest = 1.55;     // just short of straight up and down, where yaw loses its meaning
constexpr double slowest = 0.5;
constexpr double fastest = 2'000.0;  // m/s; with `fast` still within the 10,000 m/s that a view may state
constexpr double lowest_bird_m = 1'500.0;
constexpr double highest_bird_m = 60'000.0;
/// Dragging moves the camera as if the picture lay this far away, at least.
constexpr double nearest_pan_m = 4.0;

}  // namespace

double FlyCamera::speed() const {
    return below_ ? std::clamp(camera_.altitude_m * 0.4, slowest, fastest) : speed_;
}

void FlyCamera::turn(const FlyInput& input, double seconds) {
    constexpr double whole_turn = 6.283185307179586;
    const double turn_x = input.turn_x * turn_per_pixel + input.rotate_x * fastest_turn * seconds;
    camera_.yaw = std::remainder(camera_.yaw + turn_x, whole_turn);
    if (below_) return;
    const double turn_y = input.turn_y * turn_per_pixel + input.rotate_y * fastest_turn * seconds;
    camera_.pitch = std::clamp(camera_.pitch - turn_y, -steepest, steepest);
}

void FlyCamera::change_by_wheel(double steps) {
    if (below_)
        camera_.altitude_m =
            std::clamp(camera_.altitude_m * std::pow(1.25, -steps), lowest_bird_m / 10, highest_bird_m);
    else
        speed_ = std::clamp(speed_ * std::pow(1.25, steps), slowest, fastest);
}

void FlyCamera::fly(const FlyInput& input, double seconds) {
    turn(input, seconds);
    change_by_wheel(input.wheel);
    const glm::dvec3 north(std::sin(camera_.yaw), 0.0, -std::cos(camera_.yaw));
    const glm::dvec3 ahead = below_ ? north : forward_of(camera_);
    const glm::dvec3 right(std::cos(camera_.yaw), 0.0, std::sin(camera_.yaw));
    const double share = (input.fast ? 5.0 : 1.0) * (input.slow ? 0.2 : 1.0);
    velocity_ = (ahead * input.ahead + right * input.right + glm::dvec3(0, input.up, 0)) * (speed() * share);
    // The picture follows the mouse: the camera goes the other way.
    const double metres_per_pixel =
        std::max(camera_.altitude_m, nearest_pan_m) * static_cast<double>(radians_per_pixel(camera_));
    const glm::dvec3 up_in_picture = below_ ? north : glm::dvec3(0, 1, 0);
    const glm::dvec3 drag = (up_in_picture * input.pan_y - right * input.pan_x) * metres_per_pixel;
    const double height = camera_.altitude_m;
    move(camera_, velocity_.x * seconds + drag.x, velocity_.y * seconds + drag.y,
         velocity_.z * seconds + drag.z);
    // Looking straight down there is no horizon, and a bird may be higher than others.
    if (below_)
        camera_.altitude_m = std::clamp(height + velocity_.y * seconds, lowest_bird_m / 10, highest_bird_m);
}

void FlyCamera::set_birds_eye(bool above) {
    if (above == birds_eye()) return;
    if (above) {
        below_ = camera_;
        camera_.altitude_m = std::clamp(camera_.altitude_m * 20.0, lowest_bird_m, highest_bird_m);
        camera_.pitch = -steepest;
    } else {
        camera_.altitude_m = below_->altitude_m;
        camera_.pitch = below_->pitch;
        below_.reset();
    }
}

void FlyCamera::go_to(const Camera& camera) {
    const uint32_t width = camera_.width;
    const uint32_t height = camera_.height;
    below_.reset();
    camera_ = camera;
    resize(width, height);
}

void FlyCamera::resize(uint32_t width, uint32_t height) {
    camera_.width = std::clamp<uint32_t>(width, 1, most_pixels);
    camera_.height = std::clamp<uint32_t>(height, 1, most_pixels);
}

}  // namespace trochoid
