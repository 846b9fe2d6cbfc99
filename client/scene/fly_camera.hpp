#pragma once
#include <glm/vec3.hpp>

#include "client/scene/camera.hpp"

namespace trochoid {

/// What the person at the controls asks for during one frame.
struct FlyInput {
    double ahead = 0;   ///< -1 to 1: forwards along the line of sight
    double right = 0;   ///< -1 to 1
    double up = 0;      ///< -1 to 1: straight up
    double turn_x = 0;  ///< pixels that the mouse moved while it steers, right positive
    double turn_y = 0;  ///< down positive
    double wheel = 0;   ///< steps: each makes the speed a quarter larger or smaller
    bool fast = false;  ///< five times as fast
    bool operator==(const FlyInput&) const = default;
};

/// A camera that flies: WASD or arrows, Q and E, the mouse looks.
class FlyCamera {
public:
    explicit FlyCamera(Camera start) : camera_(start) {}
    /// Moves by what was asked for over a frame of so many seconds.
    void fly(const FlyInput& input, double seconds);
    void resize(uint32_t width, uint32_t height);

    const Camera& camera() const { return camera_; }
    /// Metres per second over the last frame, east, up, south.
    glm::dvec3 velocity() const { return velocity_; }
    double speed() const { return speed_; }

private:
    Camera camera_;
    glm::dvec3 velocity_{0};
    double speed_ = 20.0;  // m/s
};

}  // namespace trochoid
