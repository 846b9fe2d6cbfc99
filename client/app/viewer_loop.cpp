#include "client/app/viewer_loop.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <optional>
#include <thread>

#include "client/app/viewing.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A server that is gone for so long ends a run that only files see.
class ServerWatch {
public:
    explicit ServerWatch(const ViewerOptions& options) : options_(options) {}

    void look(const SourceStatistics& statistics) {
        if (statistics.connected)
            gone_since_.reset();
        else if (!gone_since_)
            gone_since_ = Clock::now();
        if (options_.offscreen && gone_since_ && seconds_since(*gone_since_) > options_.patience_s)
            throw_gone(statistics, "and did not come back within --patience.");
    }
    /// The files of such a run show an old sea.
    void look_at_end(const SourceStatistics& statistics) const {
        if (options_.offscreen && gone_since_)
            throw_gone(statistics, "before the end; what was written shows the sea as it was known.");
    }

private:
    [[noreturn]] void throw_gone(const SourceStatistics& statistics, const char* rest) const {
        throw ServerGone(fmt::format("The server {} went away {:.1f} s ago ({}) {}", options_.connect,
                                     seconds_since(*gone_since_), statistics.state, rest));
    }

    const ViewerOptions& options_;
    std::optional<Clock::time_point> gone_since_;
};

/// Draws until the first patches have come, and for pictures that shall be the same on every run until no more come; false
/// where `stop` or the window ended it. Offscreen nobody sees the wait, so it has a limit.
bool await_sea(Viewing& viewing, const ViewerOptions& options, const std::function<bool()>& stop) {
    const auto start = Clock::now();
    while (!stop() && !viewing.closed()) {
        viewing.frame();
        if (viewing.has_sea() && (!viewing.sea_clock().repeatable() || viewing.settled())) return true;
        const bool over = seconds_since(start) > options.patience_s;
        // A sea that never stops telling is better drawn late than never.
        if (viewing.has_sea() && over) return true;
        if (options.offscreen && over)
            throw OperatorError(fmt::format(
                "No sea came from {} within {:.0f} s ({}). Start trochoid-server there, or name another with --connect.",
                options.connect, options.patience_s, viewing.statistics().state));
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
}

/// `frames` 0 and `seconds` 0: no such end.
void run_for(Viewing& viewing, ServerWatch& watch, double seconds, uint64_t frames,
             const std::function<bool()>& stop) {
    const auto start = Clock::now();
    const uint64_t first = viewing.frames();
    const double shown = viewing.sea_clock().shown_s();
    while (!stop() && !viewing.closed()) {
        const double passed =
            viewing.sea_clock().stepped() ? viewing.sea_clock().shown_s() - shown : seconds_since(start);
        // Half a microsecond: sums of steps are whole microseconds.
        if (seconds > 0 && passed >= seconds - 5e-7) return;
        if (frames > 0 && viewing.frames() - first >= frames) return;
        viewing.frame();
        watch.look(viewing.statistics());
    }
}

void keep_settings(const Viewing& viewing, const ViewerOptions& options, const std::filesystem::path& file) {
    if (!options.keeps_settings || file.empty()) return;
    try {
        save_settings(file, viewing.settings());
    } catch (const OperatorError& error) {
        spdlog::warn("{}", error.what());
    }
}

}  // namespace

ViewerSummary run_viewer(SeaSource& source, const ViewerOptions& options, const std::function<bool()>& stop,
                         const std::filesystem::path& settings) {
    Viewing viewing(source, options);
    ServerWatch watch(options);
    if (await_sea(viewing, options, stop)) {
        viewing.begin();
        run_for(viewing, watch, options.seconds, options.frames, stop);
        viewing.write_picture(options.picture);
        if (!options.second_picture.empty()) {
            run_for(viewing, watch, options.second_picture_after, 0, stop);
            viewing.write_picture(options.second_picture);
        }
        viewing.finish_recording();
    }
    ViewerSummary summary = viewing.summary();
    if (!options.summary_json.empty()) write_summary(options.summary_json, summary);
    keep_settings(viewing, options, settings);
    watch.look_at_end(summary.source);
    return summary;
}

}  // namespace trochoid
