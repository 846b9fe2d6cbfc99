#include "client/app/viewer_loop.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <thread>

#include "client/gpu/offscreen_context.hpp"
#include "client/gpu/overlay.hpp"
#include "client/gpu/picture_file.hpp"
#include "client/gpu/renderer.hpp"
#include "client/gpu/window.hpp"
#include "client/scene/camera_floor.hpp"
#include "client/scene/fly_camera.hpp"
#include "client/scene/layer_names.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
}

/// How often a box's rays are asked for while they are shown.
constexpr double rays_every_s = 2.0;
/// Frame times that the overlay's rate is taken over.
constexpr size_t recent_frames = 30;

/// One run from its first frame to its last.
class Viewing {
public:
    Viewing(SeaSource& source, const ViewerOptions& options)
        : source_(source),
          draw_(draw_options_of(options)),
          fly_(options.camera),
          overlay_shown_(options.overlay) {
        if (options.offscreen)
            offscreen_ = std::make_unique<OffscreenContext>();
        else
            window_ = std::make_unique<Window>("Trochoid", options.camera.width, options.camera.height);
        renderer_ = std::make_unique<Renderer>();
        overlay_ = std::make_unique<Overlay>(window_.get());
        spdlog::info("{}", describe_gl());
    }

    bool closed() const { return window_ && window_->wants_close(); }
    bool has_sea() const { return report_.patches_known > 0; }
    const SourceStatistics& statistics() const { return statistics_; }

    void frame() {
        const auto now = Clock::now();
        const double seconds = last_frame_ == Clock::time_point{} ? 0.0 : seconds_between(last_frame_, now);
        last_frame_ = now;
        steer(std::min(seconds, 0.25));
        tell_view();
        const SceneInput input = source_.snapshot();
        note(input);
        Camera camera = fly_.camera();
        floor_.lift(camera, input);
        resize(camera);
        report_ = renderer_->draw(*target_, input, camera, frozen_.value_or(camera), draw_);
        overlay_->draw(content(input, camera), overlay_shown_, target_->width(), target_->height());
        show();
        if (seconds > 0.0 && has_sea()) record(seconds);
    }

    void write_picture(const std::string& path) const {
        if (path.empty()) return;
        write_png(path, target_->read());
        spdlog::info("wrote {}", path);
    }

    ViewerSummary summary() const {
        ViewerSummary s;
        const double frame_s = median_of(frame_seconds_);
        s.median_fps = frame_s > 0 ? 1.0 / frame_s : 0.0;
        s.median_cpu_ms = median_of(cpu_ms_);
        s.median_gpu_ms = median_of(gpu_ms_);
        s.frames = frame_seconds_.size();
        s.last = report_;
        s.source = statistics_;
        s.sea_time = sea_time_;
        s.gl = describe_gl();
        return s;
    }

private:
    void steer(double seconds) {
        if (!window_) return;
        window_->poll();
        for (const Toggle toggle : window_->take_toggles()) switch_on_or_off(toggle);
        for (const int digit : window_->take_digits())
            draw_.layers = toggled(draw_.layers, layers_by_importance[static_cast<size_t>(digit - 1)].layer);
        fly_.resize(window_->pixel_width(), window_->pixel_height());
        fly_.fly(window_->take_input(), seconds);
    }

    void switch_on_or_off(Toggle toggle) {
        switch (toggle) {
            case Toggle::overlay: overlay_shown_ = !overlay_shown_; break;
            case Toggle::wireframe: draw_.wireframe = !draw_.wireframe; break;
            case Toggle::boxes: draw_.boxes = !draw_.boxes; break;
            case Toggle::rays: draw_.rays = !draw_.rays; break;
            case Toggle::patches: draw_.patches = !draw_.patches; break;
            case Toggle::fields: draw_.fields = !draw_.fields; break;
            case Toggle::freeze: frozen_ = frozen_ ? std::nullopt : std::optional(fly_.camera()); break;
        }
    }

    void tell_view() {
        ViewState view = view_of(frozen_.value_or(fly_.camera()), frozen_ ? glm::dvec3(0) : fly_.velocity());
        view.accepted_error_px = draw_.error_px;
        source_.set_view(view);
    }

    void note(const SceneInput& input) {
        report_link(input.statistics.state);
        statistics_ = input.statistics;
        sea_time_ = input.now;
        if (!draw_.rays || !input.state || seconds_between(rays_asked_, last_frame_) < rays_every_s) return;
        rays_asked_ = last_frame_;
        for (const auto& [id, box] : input.state->boxes) source_.request_rays(id);
    }

    /// Says how the link does, but not every second of a countdown, which stands behind the last comma.
    void report_link(const std::string& state) {
        const std::string news = state.substr(0, state.rfind(','));
        if (news == reported_link_) return;
        reported_link_ = news;
        spdlog::info("{}", state);
    }

    void resize(const Camera& camera) {
        if (target_ && target_->width() == camera.width && target_->height() == camera.height) return;
        target_.reset();
        target_ = std::make_unique<RenderTarget>(camera.width, camera.height, draw_.samples);
    }

    void show() {
        if (window_) {
            target_->copy_to_window(window_->pixel_width(), window_->pixel_height());
            window_->show_frame();
        } else {
            // Without a window nothing else waits for the picture, and frame times would be those of giving commands.
            glFinish();
        }
    }

    void record(double seconds) {
        frame_seconds_.push_back(seconds);
        cpu_ms_.push_back(report_.cpu_ms);
        gpu_ms_.push_back(report_.gpu_ms);
    }

    OverlayContent content(const SceneInput& input, const Camera& camera) const {
        const size_t count = std::min(frame_seconds_.size(), recent_frames);
        const double frame_s =
            median_of({frame_seconds_.end() - static_cast<ptrdiff_t>(count), frame_seconds_.end()});
        return {report_,
                input.statistics,
                input.now,
                camera,
                fly_.speed(),
                frame_s > 0 ? 1.0 / frame_s : 0.0,
                frame_s * 1e3,
                draw_,
                frozen_.has_value()};
    }

    SeaSource& source_;
    DrawOptions draw_;
    FlyCamera fly_;
    CameraFloor floor_;
    bool overlay_shown_;
    std::optional<Camera> frozen_;
    // The context goes last.
    std::unique_ptr<OffscreenContext> offscreen_;
    std::unique_ptr<Window> window_;
    std::unique_ptr<Renderer> renderer_;
    std::unique_ptr<Overlay> overlay_;
    std::unique_ptr<RenderTarget> target_;

    FrameReport report_;
    SourceStatistics statistics_;
    std::string reported_link_;
    SeaTime sea_time_;
    Clock::time_point last_frame_;
    Clock::time_point rays_asked_;
    std::vector<double> frame_seconds_;
    std::vector<double> cpu_ms_;
    std::vector<double> gpu_ms_;
};

/// Draws until the first patches have come; false where `stop` or the window ended it. Offscreen nobody sees the wait, so it
/// has a limit.
bool await_sea(Viewing& viewing, const ViewerOptions& options, const std::function<bool()>& stop) {
    const auto start = Clock::now();
    while (!stop() && !viewing.closed()) {
        viewing.frame();
        if (viewing.has_sea()) return true;
        if (options.offscreen && seconds_between(start, Clock::now()) > options.patience_s)
            throw OperatorError(fmt::format(
                "No sea came from {} within {:.0f} s ({}). Start trochoid-server there, or name another with --connect.",
                options.connect, options.patience_s, viewing.statistics().state));
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
}

void run_for(Viewing& viewing, double seconds, const std::function<bool()>& stop) {
    const auto start = Clock::now();
    while (!stop() && !viewing.closed() && (seconds == 0 || seconds_between(start, Clock::now()) < seconds))
        viewing.frame();
}

}  // namespace

ViewerSummary run_viewer(SeaSource& source, const ViewerOptions& options, const std::function<bool()>& stop) {
    Viewing viewing(source, options);
    if (await_sea(viewing, options, stop)) {
        run_for(viewing, options.seconds, stop);
        viewing.write_picture(options.picture);
        if (!options.second_picture.empty()) {
            run_for(viewing, options.second_picture_after, stop);
            viewing.write_picture(options.second_picture);
        }
    }
    ViewerSummary summary = viewing.summary();
    if (!options.summary_json.empty()) write_summary(options.summary_json, summary);
    return summary;
}

}  // namespace trochoid
