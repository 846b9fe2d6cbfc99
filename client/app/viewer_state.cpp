#include "client/app/viewer_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "client/app/viewer_presets.hpp"
#include "client/scene/layer_names.hpp"

namespace trochoid {

namespace {

constexpr double usual_target_ms = 1e3 / 30.0;
constexpr double hour_step = 0.25;

template <class T>
T next_of(T value, int count) {
    return static_cast<T>((static_cast<int>(value) + 1) % count);
}

}  // namespace

ViewerState::ViewerState(const ViewerOptions& options)
    : wanted_(options.draw),
      quality_(options.quality),
      preset_(options.preset),
      fly_(options.camera),
      panels_(options.panels),
      last_target_ms_(options.target_ms > 0 ? options.target_ms : usual_target_ms) {
    if (options.target_ms > 0) budget_.emplace(options.target_ms, late_pictures_);
    if (options.freeze) frozen_ = fly_.camera();
    if (options.birds_eye) set_birds_eye(true);
}

void ViewerState::expect_times_late(uint32_t pictures) {
    late_pictures_ = pictures;
    if (budget_) budget_.emplace(budget_->target_ms(), late_pictures_);
}

void ViewerState::set_birds_eye(bool above) {
    if (above) boxes_before_ = wanted_.boxes;
    fly_.set_birds_eye(above);
    wanted_.boxes = above || boxes_before_;
}

void ViewerState::switch_budget(std::string& notice) {
    if (budget_) {
        last_target_ms_ = budget_->target_ms();
        budget_.reset();
        notice = "No target: everything that is wanted is drawn";
    } else {
        budget_.emplace(last_target_ms_, late_pictures_);
        notice = fmt::format("Holding {:.1f} ms a frame", last_target_ms_);
    }
}

void ViewerState::press_panel_or_view(Action action) {
    switch (action) {
        case Action::help: panels_.help = !panels_.help; break;
        case Action::overlay: panels_.numbers = !panels_.numbers; break;
        case Action::timers: panels_.timers = !panels_.timers; break;
        case Action::wireframe: wanted_.wireframe = !wanted_.wireframe; break;
        case Action::boxes: wanted_.boxes = !wanted_.boxes; break;
        case Action::rays: wanted_.rays = !wanted_.rays; break;
        case Action::patches: wanted_.patches = !wanted_.patches; break;
        case Action::fields: wanted_.fields = !wanted_.fields; break;
        case Action::freeze: frozen_ = frozen_ ? std::nullopt : std::optional(fly_.camera()); break;
        case Action::birds_eye: set_birds_eye(!fly_.birds_eye()); break;
        case Action::spray: wanted_.spray = !wanted_.spray; break;
        case Action::foam_history: wanted_.foam_history = !wanted_.foam_history; break;
        case Action::ships: wanted_.ships = !wanted_.ships; break;
        default: break;
    }
}

void ViewerState::press_choice(Action action, std::string& notice) {
    switch (action) {
        case Action::next_preset:
            if (fly_.birds_eye()) set_birds_eye(false);
            next_preset(preset_, fly_, wanted_, quality_);
            notice = fmt::format("Camera and light of the preset {}", preset_);
            break;
        case Action::next_quality:
            quality_ = next_of(quality_, 3);
            set_quality(wanted_, quality_);
            notice = fmt::format("Quality {}", name_of(quality_));
            break;
        case Action::next_mesher:
            wanted_.mesher = next_of(wanted_.mesher, 4);
            notice = fmt::format("Mesher {}", name_of(wanted_.mesher));
            break;
        case Action::next_displacement:
            wanted_.displacement = next_of(wanted_.displacement, 3);
            notice = fmt::format("Displacement {}", name_of(wanted_.displacement));
            break;
        case Action::next_far_method:
            wanted_.far_method = next_of(wanted_.far_method, 3);
            notice = fmt::format("Far method {}", name_of(wanted_.far_method));
            break;
        case Action::next_refinement:
            wanted_.refinement = next_of(wanted_.refinement, 3);
            notice = fmt::format("Refined by {}", name_of(wanted_.refinement));
            break;
        case Action::earlier: wanted_.hour = std::fmod(wanted_.hour - hour_step + 24.0, 24.0); break;
        case Action::later: wanted_.hour = std::fmod(wanted_.hour + hour_step, 24.0); break;
        case Action::budget: switch_budget(notice); break;
        default: break;
    }
    if (action == Action::earlier || action == Action::later) {
        const int minutes = static_cast<int>(std::lround(wanted_.hour * 60.0));
        notice = fmt::format("Light of {:02}:{:02}", minutes / 60, minutes % 60);
    }
}

bool ViewerState::press(const KeyPress& press, std::string& notice) {
    switch (press.action) {
        case Action::close:
        case Action::full_screen:
        case Action::picture:
        case Action::record: return false;
        case Action::layer: {
            const NamedLayer& layer = layers_by_importance[press.layer];
            wanted_.layers = toggled(wanted_.layers, layer.layer);
            notice = fmt::format("{} {}", layer.about, wanted_.layers.has(layer.layer) ? "on" : "off");
            return true;
        }
        default:
            press_panel_or_view(press.action);
            press_choice(press.action, notice);
            return true;
    }
}

void ViewerState::keep_in_reach(std::string& notice) {
    if (!frozen_) return;
    const LatticePoint here = fly_.camera().position;
    const int64_t away =
        std::max(std::abs(here.x - frozen_->position.x), std::abs(here.z - frozen_->position.z));
    if (away <= anchor_reach) return;
    frozen_.reset();
    notice = fmt::format("The culling camera was left {:.0f} km behind, out of reach: it follows again",
                         to_metres(away) / 1e3);
}

DrawOptions ViewerState::in_force() const { return budget_ ? budget_->apply(wanted_) : wanted_; }

void ViewerState::took(double load_ms, Layers present) {
    if (budget_) budget_->add(load_ms, wanted_, present);
}

float ViewerState::error_for_server() const {
    const double factor = budget_ ? budget_->report().error_factor : 1.0;
    const double step = std::floor(2.0 * std::log2(factor) + 1e-9);
    return std::min(wanted_.error_px * static_cast<float>(std::exp2(step / 2.0)), 100.0F);
}

}  // namespace trochoid
