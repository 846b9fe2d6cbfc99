#pragma once
#include <functional>

#include "client/app/viewer_options.hpp"
#include "client/app/viewer_summary.hpp"
#include "client/scene/sea_source.hpp"

namespace trochoid {

/// Shows a sea until the window is closed, the seconds are over or `stop` says so; writes what the options ask for. Throws
/// OperatorError where there is no OpenGL, a file cannot be written, or (offscreen) no sea has come in time.
ViewerSummary run_viewer(SeaSource& source, const ViewerOptions& options, const std::function<bool()>& stop);

}  // namespace trochoid
