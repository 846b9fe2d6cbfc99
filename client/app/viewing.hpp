#pragma once
#include <chrono>
#include <ctime>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/app/recording.hpp"
#include "client/app/sea_clock_choice.hpp"
#include "client/app/viewer_options.hpp"
#include "client/app/viewer_state.hpp"
#include "client/app/viewer_summary.hpp"
#include "client/gpu/gl_health.hpp"
#include "client/gpu/offscreen_context.hpp"
#include "client/gpu/overlay.hpp"
#include "client/gpu/renderer.hpp"
#include "client/gpu/window.hpp"
#include "client/scene/camera_floor.hpp"
#include "client/scene/sea_source.hpp"

namespace trochoid {

/// One run of the viewer from its first frame to its last: a context or a window, what draws, what the person has chosen, and what is
/// recorded.
class Viewing {
public:
    Viewing(SeaSource& source, const ViewerOptions& options);
    Viewing(const Viewing&) = delete;
    Viewing& operator=(const Viewing&) = delete;
    ~Viewing() = default;

    bool closed() const { return window_ && window_->wants_close(); }
    bool has_sea() const { return report_.patches_known > 0; }
    /// Whether nothing new has come for a moment.
    bool settled() const;
    const SourceStatistics& statistics() const { return statistics_; }
    const SeaClockChoice& sea_clock() const { return sea_clock_; }
    uint64_t frames() const { return counted_frames_; }

    /// From here on frames count, are timed and recorded.
    void begin();
    /// Steers, draws and shows one picture. Throws OperatorError and GraphicsError.
    void frame();

    void write_picture(const std::string& path);
    /// Ends a recording, if there is one.
    void finish_recording();
    ViewerSummary summary() const;
    ViewerSettings settings() const;
    /// Told to the person for some seconds, and logged.
    void tell(const std::string& notice);

private:
    using Clock = std::chrono::steady_clock;

    void steer(double seconds);
    void press(const KeyPress& press);
    void switch_recording();
    void start_recording(const std::string& where);
    void stop_recording_with(const std::string& why);
    void tell_view();
    SceneInput take_input();
    void tell_of_wait(SeaTime wanted, SeaTime known_until);
    void note(const SceneInput& input);
    void report_link(const std::string& state);
    void draw(const SceneInput& input);
    void resize(const Camera& camera, const DrawOptions& options);
    void capture();
    void show();
    void count(double seconds, double load_ms);
    double load_ms(double busy_ms) const;
    void account_trains(const SceneInput& input, const Camera& camera);
    OverlayContent content(const SceneInput& input, const Camera& camera) const;
    void show_title();

    SeaSource& source_;
    const ViewerOptions options_;
    ViewerState state_;
    CameraFloor floor_;
    SeaClockChoice sea_clock_;
    bool shows_known_time_ = true;  // the sea of the picture at hand is known for its time

    // The context goes last.
    std::unique_ptr<OffscreenContext> offscreen_;
    std::unique_ptr<Window> window_;
    std::unique_ptr<Renderer> renderer_;
    std::unique_ptr<Overlay> overlay_;
    std::unique_ptr<RenderTarget> target_;
    std::unique_ptr<GlHealth> health_;
    bool software_ = false;
    // Of the target.
    uint32_t samples_ = 1;
    float scale_ = 1.0F;

    std::unique_ptr<Recording> recording_;
    Clock::time_point recording_since_;
    bool told_of_wait_ = false;
    std::string notice_;
    Clock::time_point notice_until_;
    std::string title_;

    FrameReport report_;
    SourceStatistics statistics_;
    std::optional<TrainAccount> trains_;
    Clock::time_point trains_at_;
    std::string reported_link_;
    SeaTime sea_time_;
    Clock::time_point last_frame_;
    Clock::time_point rays_asked_;
    // What came last, and when.
    std::shared_ptr<const InterestState> last_state_;
    Layers present_ = displayed_layers;  // in it
    size_t last_tiles_ = 0;
    Clock::time_point last_news_;

    bool begun_ = false;
    uint64_t counted_frames_ = 0;
    uint64_t recorded_pictures_ = 0;
    uint64_t timed_frames_ = 0;
    std::vector<double> frame_seconds_;
    std::vector<double> cpu_ms_;
    std::vector<double> gpu_ms_;
    std::map<std::string, std::vector<double>> pass_ms_;
};

}  // namespace trochoid
