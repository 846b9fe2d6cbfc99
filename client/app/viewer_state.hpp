#pragma once
#include <optional>
#include <string>

#include "client/app/viewer_options.hpp"
#include "client/gpu/key_bindings.hpp"
#include "client/scene/fly_camera.hpp"
#include "client/scene/frame_budget.hpp"

namespace trochoid {

/// What the keys change of a picture: values only, no window and no OpenGL.
class ViewerState {
public:
    explicit ViewerState(const ViewerOptions& options);
    /// So many pictures after a change are drawn before what they took is known; 5 if nobody says otherwise.
    void expect_times_late(uint32_t pictures);
    void set_lean(bool lean) { wanted_.lean = lean; }

    /// What a key asks for, as far as it is of the picture; false for those that are of the window or of files (close, full screen,
    /// picture, record). Gives words for people in `notice`, which is empty where the picture says enough.
    bool press(const KeyPress& press, std::string& notice);

    /// A culling camera that was left so far behind (262 km) that no picture from here reaches its sea follows again; says so in `notice`.
    void keep_in_reach(std::string& notice);

    /// All that is wanted, less what the controller has given up.
    DrawOptions in_force() const;
    /// Takes what a picture of a sea with these layers took.
    void took(double load_ms, Layers present = displayed_layers);
    /// Error that the server is told: in steps of a factor of sqrt 2, so that a controller at work does not have the server decide anew all the time.
    float error_for_server() const;

    FlyCamera& fly() { return fly_; }
    const FlyCamera& fly() const { return fly_; }
    /// The camera that the mesh is made for, where it is not the one that looks.
    const std::optional<Camera>& frozen() const { return frozen_; }
    const std::optional<FrameBudget>& budget() const { return budget_; }
    const DrawOptions& wanted() const { return wanted_; }
    OverlayPanels panels() const { return panels_; }
    Quality quality() const { return quality_; }
    const std::string& preset() const { return preset_; }
    double target_ms() const { return budget_ ? budget_->target_ms() : 0.0; }

private:
    void press_panel_or_view(Action action);
    void press_choice(Action action, std::string& notice);
    void set_birds_eye(bool above);
    void switch_budget(std::string& notice);

    DrawOptions wanted_;
    Quality quality_;
    std::string preset_;
    FlyCamera fly_;
    OverlayPanels panels_;
    std::optional<Camera> frozen_;
    bool boxes_before_ = false;  // shown before the bird's eye
    std::optional<FrameBudget> budget_;
    double last_target_ms_;
    uint32_t late_pictures_ = 5;
};

}  // namespace trochoid
