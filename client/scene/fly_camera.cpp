#include "client/scene/fly_camera.hpp"

#include <algorithm>
#include <cmath>

namespace trochoid {

namespace {

constexpr double turn_per_pixel = 0.0025;
constexpr double steepest = 1.55;  // just short of straight up and down, where yaw loses its meaning
constexpr double slowest = 0.5;
constexpr double fastest = 2'000.0;  // m/s; with `fast` still within the 10,000 m/s that a view may state

}  // namespace

void FlyCamera::fly(const FlyInput& input, double seconds) {
    constexpr double turn = 6.283185307179586;
    camera_.yaw = std::remainder(camera_.yaw + input.turn_x * turn_per_pixel, turn);
    camera_.pitch = std::clamp(camera_.pitch - input.turn_y * turn_per_pixel, -steepest, steepest);
    speed_ = std::clamp(speed_ * std::pow(1.25, input.wheel), slowest, fastest);
    const glm::dvec3 ahead = forward_of(camera_);
    const glm::dvec3 right(std::cos(camera_.yaw), 0.0, std::sin(camera_.yaw));
    velocity_ = (ahead * input.ahead + right * input.right + glm::dvec3(0, input.up, 0)) *
                (input.fast ? 5 * speed_ : speed_);
    move(camera_, velocity_.x * seconds, velocity_.y * seconds, velocity_.z * seconds);
}

void FlyCamera::resize(uint32_t width, uint32_t height) {
    camera_.width = std::clamp<uint32_t>(width, 1, 16384);
    camera_.height = std::clamp<uint32_t>(height, 1, 16384);
}

}  // namespace trochoid
