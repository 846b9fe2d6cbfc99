#pragma once
#include <optional>
#include <string>
#include <vector>

#include "client/scene/camera.hpp"
#include "client/scene/draw_options.hpp"
#include "client/scene/frame_budget.hpp"
#include "client/scene/frame_report.hpp"
#include "client/scene/scene_input.hpp"
#include "client/scene/train_account.hpp"

namespace trochoid {

/// What of the overlay is shown.
struct OverlayPanels {
    bool numbers = false;
    bool timers = false;  ///< frame graph and GPU passes
    bool help = false;
    bool operator==(const OverlayPanels&) const = default;
};

/// All that the overlay says.
struct OverlayContent {
    FrameReport report;
    SourceStatistics source;
    SeaTime now;
    bool time_held = false;  ///< the sea's clock is not the server's
    Camera camera;
    double speed = 0;  ///< of the camera, m/s
    double frames_per_second = 0;
    double frame_ms = 0;
    std::vector<float> frame_times_ms;  ///< the last ones, oldest first, at most 120
    DrawOptions options;                ///< in force
    Quality quality = Quality::medium;
    std::string preset;                  ///< empty: none
    std::optional<BudgetReport> budget;  ///< of the controller, where one holds a target
    std::optional<TrainAccount> trains;  ///< at the camera's place
    std::optional<Camera> frozen;        ///< the culling camera, where it is not the one that looks
    bool birds_eye = false;
    std::string recording;  ///< what is being recorded, empty: nothing
    std::string notice;     ///< to be told, empty: nothing
};

}  // namespace trochoid
