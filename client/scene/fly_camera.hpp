#pragma once
#include <glm/vec3.hpp>
#include <optional>

#include "client/scene/camera.hpp"

namespace trochoid {

/// What the person at the controls asks for during one frame.
struct FlyInput {
    double ahead = 0;     ///< -1 to 1: forwards along the line of sight
    double right = 0;     ///< -1 to 1
    double up = 0;        ///< -1 to 1: straight up
    double turn_x = 0;    ///< pixels that the mouse moved while it steers, right positive
    double turn_y = 0;    ///< down positive
    double pan_x = 0;     ///< pixels that the mouse dragged the picture, right positive
    double pan_y = 0;     ///< down positive
    double rotate_x = 0;  ///< -1 to 1: turns right at this share of the fastest rate
    double rotate_y = 0;  ///< -1 to 1: turns down
    double wheel = 0;     ///< steps: each makes the speed a quarter larger or smaller; from above, the height
    bool fast = false;    ///< five times as fast
    bool slow = false;    ///< a fifth as fast
    bool operator==(const FlyInput&) const = default;
};

/// A camera that flies: WASD or arrows, Q and E, the mouse looks. It can change to a bird's eye: high above its place, looking
/// straight down, where ahead is over the ground and the mouse drags the map.
class FlyCamera {
public:
    explicit FlyCamera(Camera start) : camera_(start) {}
    /// Moves by what was asked for over a frame of so many seconds.
    void fly(const FlyInput& input, double seconds);
    void resize(uint32_t width, uint32_t height);
    void go_to(const Camera& camera);

    /// Up to twenty times the height, at least 1500 m; back to the height and the line of sight of before, at the place below.
    void set_birds_eye(bool above);
    bool birds_eye() const { return below_.has_value(); }

    const Camera& camera() const { return camera_; }
    /// Metres per second over the last frame, east, up, south.
    glm::dvec3 velocity() const { return velocity_; }
    double speed() const;

private:
    void turn(const FlyInput& input, double seconds);
    void change_by_wheel(double steps);

    Camera camera_;
    std::optional<Camera> below_;  // what set_birds_eye(false) goes back to
    glm::dvec3 velocity_{0};
    double speed_ = 20.0;  // m/s
};

}  // namespace trochoid
