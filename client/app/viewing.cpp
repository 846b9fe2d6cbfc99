#include "client/app/viewing.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <thread>

#include "client/gpu/picture_file.hpp"
#include "client/scene/median.hpp"
#include "protocol/model/sea_clock.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
}

/// How often a box's rays are asked for while they are shown.
constexpr double rays_every_s = 2.0;
constexpr double trains_every_s = 0.5;
/// Frame times that the overlay's rate is taken over, and those of its graph.
constexpr size_t recent_frames = 30;
constexpr size_t graph_frames = 120;
constexpr double notice_s = 4.0;
/// A sea that has told nothing new for so long has told what it had to.
constexpr double settled_after_s = 0.8;
/// Seconds of sea time that go by in a second at most.
constexpr double fastest_sea = largest_rate_q16 / 65536.0;
/// A window draws at least this often, whatever it waits for.
constexpr double longest_wait_s = 0.1;
/// Medians are over the last frames: a window that stays open for days shall not grow.
constexpr size_t most_kept = 20'000;

/// With the pixels that are drawn, which a target of a smaller scale enlarges.
Camera scaled(Camera camera, const RenderTarget& target) {
    camera.width = target.drawn_width();
    camera.height = target.drawn_height();
    return camera;
}

void keep(std::vector<double>& values, double value) {
    if (values.size() >= most_kept) values.erase(values.begin(), values.begin() + most_kept / 2);
    values.push_back(value);
}

double seconds_of(SeaTime t) { return static_cast<double>(t.us) * 1e-6; }

/// Offscreen nobody sees a picture wait for its sea time: refuses a wait that is over, or that no patience sees the end of.
void check_wait(SeaTime wanted, SeaTime known_until, double waited_s, double patience_s) {
    const double known = seconds_of(known_until);
    const double ahead = static_cast<double>(wanted - known_until) * 1e-6;
    if (ahead > fastest_sea * patience_s)
        throw OperatorError(fmt::format(
            "Sea time {:.3f} s never comes: the sea is at {:.3f} s, and --patience, {:g} s, takes it to {:.3f} s at most "
            "({:g} s of sea time a second). Name an --at up to there, or have more patience.",
            seconds_of(wanted), known, patience_s, known + fastest_sea * patience_s, fastest_sea));
    if (waited_s > patience_s)
        throw OperatorError(fmt::format(
            "Sea time {:.3f} s is still {:.1f} s ahead of the sea, and --patience is over. Name an earlier --at, or have more "
            "patience.",
            seconds_of(wanted), ahead));
}

}  // namespace

Viewing::Viewing(SeaSource& source, const ViewerOptions& options)
    : source_(source), options_(options), state_(options), sea_clock_(options.at_s, options.fixed_step_s) {
    if (options.offscreen)
        offscreen_ = std::make_unique<OffscreenContext>();
    else
        window_ = std::make_unique<Window>("Trochoid", options.camera.width, options.camera.height,
                                           options.full_screen);
    health_ = std::make_unique<GlHealth>();
    renderer_ = std::make_unique<Renderer>();
    overlay_ = std::make_unique<Overlay>(window_.get(), options.text_scale);
    software_ = is_software_gl();
    state_.set_lean(options.lean.value_or(software_));
    // Then each picture is done when its time is taken.
    if (software_ || !window_) state_.expect_times_late(1);
    last_news_ = Clock::now();
    spdlog::info("{}", describe_gl());
}

bool Viewing::settled() const { return seconds_between(last_news_, Clock::now()) > settled_after_s; }

void Viewing::begin() {
    sea_clock_.begin(statistics_.known_until == end_of_time ? sea_time_ : statistics_.known_until);
    begun_ = true;
    if (!options_.record.empty()) start_recording(options_.record);
}

void Viewing::frame() {
    const auto now = Clock::now();
    const double seconds = last_frame_ == Clock::time_point{} ? 0.0 : seconds_between(last_frame_, now);
    last_frame_ = now;
    steer(std::min(seconds, 0.25));
    if (window_ && window_->minimised() && !recording_) {
        window_->wait();
        note(source_.snapshot());
        return;
    }
    tell_view();
    const SceneInput input = take_input();
    const auto start = Clock::now();
    draw(input);
    const auto drawn = Clock::now();
    capture();
    const auto captured = Clock::now();
    show();
    if (const std::string news = health_->check(); !news.empty()) spdlog::warn("{}", news);
    const double busy_ms = (seconds_between(start, drawn) + seconds_between(captured, Clock::now())) * 1e3;
    if (seconds > 0.0 && has_sea()) count(seconds, load_ms(busy_ms));
}

void Viewing::steer(double seconds) {
    if (!window_) return;
    window_->poll();
    for (const KeyPress& key : window_->take_presses()) press(key);
    FlyCamera& fly = state_.fly();
    fly.resize(window_->pixel_width(), window_->pixel_height());
    fly.fly(window_->take_input(), seconds);
    std::string notice;
    state_.keep_in_reach(notice);
    if (!notice.empty()) tell(notice);
}

void Viewing::press(const KeyPress& key) {
    std::string notice;
    if (state_.press(key, notice)) {
        if (!notice.empty()) tell(notice);
        return;
    }
    try {
        if (key.action == Action::close) window_->close();
        if (key.action == Action::full_screen) window_->set_full_screen(!window_->full_screen());
        if (key.action == Action::picture) write_picture(stamped_name(std::time(nullptr), ".png"));
        if (key.action == Action::record) switch_recording();
    } catch (const OperatorError& error) {
        // In a window a full disk is no reason to end.
        tell(error.what());
    }
}

void Viewing::tell(const std::string& notice) {
    notice_ = notice;
    notice_until_ =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(notice_s));
    spdlog::info("{}", notice);
}

void Viewing::switch_recording() {
    if (recording_)
        finish_recording();
    else
        start_recording(stamped_name(std::time(nullptr), ""));
}

void Viewing::start_recording(const std::string& where) {
    const double rate = sea_clock_.stepped() ? 1.0 / sea_clock_.step_s() : Recording::usual_rate;
    recording_ = std::make_unique<Recording>(where, rate, sea_clock_.stepped());
    recording_since_ = Clock::now();
    spdlog::info("recording to {}, {:.4g} pictures a second", where, rate);
}

void Viewing::finish_recording() {
    if (!recording_) return;
    const std::unique_ptr<Recording> done = std::move(recording_);
    recorded_pictures_ += done->pictures();
    done->finish();
    tell(fmt::format("recorded {} pictures to {}", done->pictures(), done->where()));
}

void Viewing::stop_recording_with(const std::string& why) {
    recorded_pictures_ += recording_->pictures();
    recording_.reset();
    tell(why);
}

void Viewing::tell_view() {
    const auto& frozen = state_.frozen();
    ViewState view =
        view_of(frozen.value_or(state_.fly().camera()), frozen ? glm::dvec3(0) : state_.fly().velocity());
    view.accepted_error_px = state_.error_for_server();
    source_.set_view(view);
}

/// The sea to draw, at the time to draw it at. Where that time is still to come this waits: a window a moment only, and shows what is known meanwhile.
SceneInput Viewing::take_input() {
    const auto start = Clock::now();
    while (true) {
        SceneInput input = source_.snapshot();
        note(input);
        const auto wanted = sea_clock_.time();
        shows_known_time_ = !wanted || *wanted <= input.statistics.known_until;
        const double waited = seconds_between(start, Clock::now());
        if (shows_known_time_ || (window_ && waited > longest_wait_s) || !input.state) {
            if (wanted && shows_known_time_) input.now = *wanted;
            sea_time_ = input.now;
            if (wanted && input.state) tell_of_wait(*wanted, input.statistics.known_until);
            return input;
        }
        if (!window_) check_wait(*wanted, input.statistics.known_until, waited, options_.patience_s);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
}

/// A window shows the sea as it is until the time asked for has come: once that is said.
void Viewing::tell_of_wait(SeaTime wanted, SeaTime known_until) {
    const bool waits = wanted - known_until > microseconds_per_second;
    if (waits && !told_of_wait_)
        tell(fmt::format("Sea time {:.3f} s is {:.1f} s ahead: until then the sea as it is",
                         seconds_of(wanted), static_cast<double>(wanted - known_until) * 1e-6));
    told_of_wait_ = waits;
}

void Viewing::note(const SceneInput& input) {
    report_link(input.statistics.state);
    statistics_ = input.statistics;
    if (input.state != last_state_ || input.tiles.size() != last_tiles_) {
        if (input.state && input.state != last_state_) present_ = layers_in(*input.state);
        last_state_ = input.state;
        last_tiles_ = input.tiles.size();
        last_news_ = Clock::now();
    }
    if (!state_.wanted().rays || !input.state || seconds_between(rays_asked_, last_frame_) < rays_every_s)
        return;
    rays_asked_ = last_frame_;
    for (const auto& [id, box] : input.state->boxes) source_.request_rays(id);
}

/// Says how the link does, but not every second of a countdown, which stands behind the last comma.
void Viewing::report_link(const std::string& state) {
    const std::string news = state.substr(0, state.rfind(','));
    if (news == reported_link_) return;
    reported_link_ = news;
    spdlog::info("{}", state);
}

void Viewing::draw(const SceneInput& input) {
    Camera camera = state_.fly().camera();
    floor_.lift(camera, input);
    const DrawOptions options = state_.in_force();
    resize(camera, options);
    report_ = renderer_->draw(*target_, input, scaled(camera, *target_),
                              scaled(state_.frozen().value_or(camera), *target_), options);
    account_trains(input, camera);
    overlay_->draw(content(input, camera), state_.panels(), target_->width(), target_->height());
}

void Viewing::resize(const Camera& camera, const DrawOptions& options) {
    if (target_ && target_->width() == camera.width && target_->height() == camera.height &&
        samples_ == options.samples && scale_ == options.render_scale)
        return;
    target_.reset();
    target_ =
        std::make_unique<RenderTarget>(camera.width, camera.height, options.samples, options.render_scale);
    samples_ = options.samples;
    scale_ = options.render_scale;
}

/// Keeps the picture where it is recorded.
void Viewing::capture() {
    if (!recording_ || !shows_known_time_) return;
    const double seconds = seconds_between(recording_since_, Clock::now());
    if (recording_->wanted_at(seconds) == 0) return;
    try {
        recording_->add(target_->read(), seconds);
    } catch (const OperatorError& error) {
        if (!window_) throw;
        stop_recording_with(error.what());
    }
}

void Viewing::show() {
    if (window_) {
        show_title();
        target_->copy_to_window(window_->pixel_width(), window_->pixel_height());
        window_->show_frame();
    } else {
        // Without a window nothing else waits for the picture, and frame times would be those of giving commands.
        RenderTarget::finish();
    }
}

/// A recording shows in the title alone: what the picture says would be in it.
void Viewing::show_title() {
    const std::string title =
        recording_ ? fmt::format("Trochoid, recording to {}: {} s", recording_->where(),
                                 static_cast<int>(seconds_between(recording_since_, last_frame_)))
                   : "Trochoid";
    if (title == title_) return;
    title_ = title;
    window_->set_title(title);
}

/// What the picture cost: a window waits for the screen, so that only the work itself counts there.
double Viewing::load_ms(double busy_ms) const {
    if (!window_ || software_) return busy_ms;
    return std::max(report_.cpu_ms, report_.gpu_ms);
}

void Viewing::count(double seconds, double load) {
    ++timed_frames_;
    keep(frame_seconds_, seconds);
    keep(cpu_ms_, report_.cpu_ms);
    keep(gpu_ms_, report_.gpu_ms);
    for (const PassTime& pass : report_.passes) keep(pass_ms_[pass.name], pass.ms);
    state_.took(load, present_);
    if (begun_ && shows_known_time_) {
        ++counted_frames_;
        sea_clock_.advance();
    }
}

void Viewing::account_trains(const SceneInput& input, const Camera& camera) {
    const auto now = Clock::now();
    if (!input.state ||
        (trains_ && (!state_.panels().numbers || seconds_between(trains_at_, now) < trains_every_s)))
        return;
    trains_at_ = now;
    const DrawOptions options = state_.in_force();
    const DisplayFilter filter =
        filter_of(scaled(camera, *target_), options, input.statistics.error_in_force_px);
    trains_ = account_of(*input.state, camera.position, input.now,
                         vertex_spacing(filter, static_cast<float>(camera.altitude_m)), options.layers);
}

OverlayContent Viewing::content(const SceneInput& input, const Camera& camera) const {
    const auto last = [this](size_t count) {
        const size_t n = std::min(frame_seconds_.size(), count);
        return std::vector<double>{frame_seconds_.end() - static_cast<ptrdiff_t>(n), frame_seconds_.end()};
    };
    const double frame_s = median_of(last(recent_frames));
    OverlayContent c;
    c.report = report_;
    c.source = input.statistics;
    c.now = input.now;
    c.time_held = sea_clock_.time().has_value();
    c.camera = camera;
    c.speed = state_.fly().speed();
    c.frames_per_second = frame_s > 0 ? 1.0 / frame_s : 0.0;
    c.frame_ms = frame_s * 1e3;
    for (const double s : last(graph_frames)) c.frame_times_ms.push_back(static_cast<float>(s * 1e3));
    c.options = state_.in_force();
    c.quality = state_.quality();
    c.preset = state_.preset();
    if (state_.budget()) c.budget = state_.budget()->report();
    c.trains = trains_;
    c.frozen = state_.frozen();
    c.birds_eye = state_.fly().birds_eye();
    if (recording_) c.recording = fmt::format("{}, {} pictures", recording_->where(), recording_->pictures());
    // Nothing passing gets into a recording.
    if (window_ && !recording_ && Clock::now() < notice_until_) c.notice = notice_;
    return c;
}

void Viewing::write_picture(const std::string& path) {
    if (path.empty() || !target_) return;
    write_png(path, target_->read());
    tell(fmt::format("wrote {}", path));
}

ViewerSummary Viewing::summary() const {
    ViewerSummary s;
    const double frame_s = median_of(frame_seconds_);
    s.median_fps = frame_s > 0 ? 1.0 / frame_s : 0.0;
    s.median_cpu_ms = median_of(cpu_ms_);
    s.median_gpu_ms = median_of(gpu_ms_);
    s.frames = timed_frames_;
    s.last = report_;
    s.source = statistics_;
    s.sea_time = sea_time_;
    s.gl = describe_gl();
    for (const auto& [name, ms] : pass_ms_) s.median_pass_ms[name] = median_of(ms);
    s.options = state_.in_force();
    s.quality = state_.quality();
    s.preset = state_.preset();
    if (state_.budget()) s.budget = state_.budget()->report();
    s.trains = trains_;
    s.recorded_pictures = recorded_pictures_ + (recording_ ? recording_->pictures() : 0);
    return s;
}

ViewerSettings Viewing::settings() const {
    ViewerSettings s;
    if (window_) {
        s.width = window_->plain_width();
        s.height = window_->plain_height();
        s.full_screen = window_->full_screen();
    }
    s.numbers = state_.panels().numbers;
    s.quality = state_.quality();
    s.mesher = state_.wanted().mesher;
    s.far_method = state_.wanted().far_method;
    s.refinement = state_.wanted().refinement;
    s.target_ms = state_.target_ms();
    return s;
}

}  // namespace trochoid
