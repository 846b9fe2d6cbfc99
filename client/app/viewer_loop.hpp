#pragma once
#include <functional>
#include <stdexcept>

#include "client/app/viewer_options.hpp"
#include "client/app/viewer_summary.hpp"
#include "client/scene/sea_source.hpp"

namespace trochoid {

/// The server went away while nobody but files could see it (offscreen). main prints it and exits 1.
class ServerGone : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Shows a sea until the window is closed, the seconds or frames are over or `stop` says so; writes what the options ask
/// for, and keeps the window's settings in `settings` (empty: nowhere). Throws OperatorError where there is no OpenGL, a file cannot be written, or
/// (offscreen) no sea has come in time; GraphicsError where the driver fails; ServerGone.
ViewerSummary run_viewer(SeaSource& source, const ViewerOptions& options, const std::function<bool()>& stop,
                         const std::filesystem::path& settings = {});

}  // namespace trochoid
