#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "client/scene/frame_report.hpp"
#include "client/scene/scene_input.hpp"

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
    std::string gl;  ///< version and device
};

/// Median of durations or rates; 0 of nothing.
double median_of(std::vector<double> values);

/// One line for people.
std::string summary_line(const ViewerSummary& summary);
/// The same and more for programs. Throws OperatorError where the file cannot be written.
void write_summary(const std::string& path, const ViewerSummary& summary);

}  // namespace trochoid
