#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/scene/draw_options.hpp"
#include "client/scene/frame_budget.hpp"
#include "client/scene/frame_report.hpp"
#include "client/scene/scene_input.hpp"
#include "client/scene/train_account.hpp"

namespace trochoid {

/// What a run of the viewer amounted to.
struct ViewerSummary {
    double median_fps = 0;
    double median_cpu_ms = 0;
    double median_gpu_ms = 0;
    uint64_t frames = 0;
    FrameReport last;
    SourceStatistics source;
    SeaTime sea_time;
    std::string gl;                                ///< version and device
    std::map<std::string, double> median_pass_ms;  ///< on the GPU, by the pass's name
    DrawOptions options;                           ///< in force at the end
    Quality quality = Quality::medium;
    std::string preset;
    std::optional<BudgetReport> budget;  ///< where a controller held a target
    std::optional<TrainAccount> trains;  ///< at the camera's last place
    uint64_t recorded_pictures = 0;
};

/// One line for people.
std::string summary_line(const ViewerSummary& summary);
/// The same and more for programs. Throws OperatorError where the file cannot be written.
void write_summary(const std::string& path, const ViewerSummary& summary);

}  // namespace trochoid
