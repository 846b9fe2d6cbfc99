#include "client/scene/frame_budget.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "client/scene/median.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

/// Below the target by as much: what a picture takes scatters to both sides.
constexpr double aim_share = 0.95;
/// Deviations (of the logarithm) that nobody minds: 0.89 to 1.02 of the target.
constexpr double dead_band = 0.07;
constexpr size_t fewest = 5;
/// Enough where twice the time or half of it is at stake.
constexpr size_t fewest_if_urgent = 3;
constexpr double urgent = 0.6;
constexpr size_t window = 60;
constexpr size_t recent = 7;

constexpr double first_gain = 0.5;  // right where time goes with the number of vertices
constexpr double smallest_gain = 0.12;
constexpr double largest_gain = 1.5;
/// A layer comes back together with an error that cuts time by at least this power of the ratio of errors.
constexpr double certain_elasticity = 0.5;
constexpr uint64_t shortest_patience = 60;  // pictures
constexpr uint64_t longest_patience = 20'000;
/// A layer that goes this soon after it came back came back too early.
constexpr uint64_t at_once = 150;

struct Rung {
    Sacrifice what;
    std::string_view name;
    double error_limit;  // factor of the error from which on it is given up
};
constexpr std::array<Rung, 14> rungs{{
    {Sacrifice::samples, "several samples a pixel", 1.3},
    {Sacrifice::full_detail, "full detail", 1.4},
    {Sacrifice::displayed_noise, "capillary", 1.5},
    {Sacrifice::spray, "spray", 1.5},
    {Sacrifice::foam_history, "foam history", 1.7},
    {Sacrifice::noise, "noise", 2.0},
    {Sacrifice::round, "round", 2.0},
    {Sacrifice::orbits, "orbits", 2.0},
    {Sacrifice::irregular, "irregular", 2.5},
    {Sacrifice::resolution, "resolution to 0.7", 2.5},
    {Sacrifice::half_resolution, "resolution to half", 3.0},
    {Sacrifice::wakes, "wakes", 4.0},
    {Sacrifice::refraction, "refraction", 4.0},
    {Sacrifice::shelter, "shelter", 5.0},
}};
const Rung& rung_of(Sacrifice what) { return rungs[static_cast<size_t>(what)]; }

std::optional<Layer> layer_of(Sacrifice what) {
    switch (what) {
        case Sacrifice::displayed_noise: return Layer::displayed_noise;
        case Sacrifice::noise: return Layer::noise;
        case Sacrifice::round: return Layer::round;
        case Sacrifice::orbits: return Layer::orbits;
        case Sacrifice::irregular: return Layer::irregular;
        case Sacrifice::wakes: return Layer::wakes;
        case Sacrifice::refraction: return Layer::refraction;
        case Sacrifice::shelter: return Layer::shelter;
        case Sacrifice::samples:
        case Sacrifice::full_detail:
        case Sacrifice::spray:
        case Sacrifice::foam_history:
        case Sacrifice::resolution:
        case Sacrifice::half_resolution: break;
    }
    return std::nullopt;
}

bool there(Sacrifice what, const DrawOptions& options) {
    if (const auto layer = layer_of(what)) return options.layers.has(*layer);
    switch (what) {
        case Sacrifice::samples: return options.samples > 1;
        case Sacrifice::full_detail: return !options.lean;
        case Sacrifice::spray: return options.spray;
        case Sacrifice::foam_history: return options.foam_history;
        case Sacrifice::resolution: return options.render_scale > 0.7F;
        case Sacrifice::half_resolution: return options.render_scale > 0.5F;
        default: return false;
    }
}

void take_away(Sacrifice what, DrawOptions& options) {
    if (const auto layer = layer_of(what)) options.layers = options.layers.without(*layer);
    if (what == Sacrifice::samples) options.samples = 1;
    if (what == Sacrifice::full_detail) options.lean = true;
    if (what == Sacrifice::spray) options.spray = false;
    if (what == Sacrifice::foam_history) options.foam_history = false;
    if (what == Sacrifice::resolution) options.render_scale = 0.7F;
    if (what == Sacrifice::half_resolution) options.render_scale = 0.5F;
}

/// Scatter of the logarithm, as a standard deviation, from the median of deviations: outliers do not count.
double scatter_of(std::span<const double> values, double median) {
    std::vector<double> away;
    away.reserve(values.size());
    for (const double v : values) away.push_back(std::abs(std::log(v / median)));
    return 1.4826 * median_of(away);
}

/// How uncertain a median of n values is.
double uncertainty(double scatter, size_t n) { return 1.25 * scatter / std::sqrt(static_cast<double>(n)); }

}  // namespace

std::string_view name_of(Sacrifice sacrifice) { return rung_of(sacrifice).name; }

std::string_view name_of(BudgetVerdict verdict) {
    switch (verdict) {
        case BudgetVerdict::measuring: return "measuring";
        case BudgetVerdict::holding: return "holding";
        case BudgetVerdict::coarser: return "getting coarser";
        case BudgetVerdict::finer: return "getting finer";
        case BudgetVerdict::all_wanted: return "time to spare, nothing given up";
        case BudgetVerdict::exhausted: return "too slow, nothing left to give up";
    }
    return "";
}

std::vector<Sacrifice> sacrifices_of(const DrawOptions& wanted, Layers present) {
    std::vector<Sacrifice> list;
    for (const Rung& rung : rungs) {
        const auto layer = layer_of(rung.what);
        if (there(rung.what, wanted) && (!layer || present.has(*layer))) list.push_back(rung.what);
    }
    return list;
}

FrameBudget::FrameBudget(double target_ms, uint32_t passed_by)
    : target_ms_(target_ms), passed_by_(passed_by) {
    TROCHOID_ASSERT(target_ms > 0.0, "a target of {} ms", target_ms);
    take_over(wanted_, present_);
}

void FrameBudget::take_over(const DrawOptions& wanted, Layers present) {
    wanted_ = wanted;
    present_ = present;
    ladder_ = sacrifices_of(wanted, present);
    // What is given up stays a beginning of the ladder.
    size_t kept = 0;
    while (kept < given_.size() && kept < ladder_.size() && given_[kept].what == ladder_[kept]) ++kept;
    given_.erase(given_.begin() + static_cast<ptrdiff_t>(kept), given_.end());
    loads_.clear();
    to_pass_ = passed_by_;
    gain_ = first_gain;
    last_direction_ = 0;
    before_ms_ = 0.0;
}

bool FrameBudget::add(double load_ms, const DrawOptions& wanted, Layers present) {
    ++pictures_;
    if (wanted != wanted_ || present.bits != present_.bits) take_over(wanted, present);
    if (!std::isfinite(load_ms) || load_ms <= 0.0) return false;
    if (to_pass_ > 0) {
        --to_pass_;
        return false;
    }
    loads_.push_back(load_ms);
    forget_old_loads();
    return decide();
}

/// Keeps the window, and only its end where the load has changed within it.
void FrameBudget::forget_old_loads() {
    if (loads_.size() > window) loads_.erase(loads_.begin(), loads_.end() - static_cast<ptrdiff_t>(window));
    if (loads_.size() < 3 * recent) return;
    const std::span<const double> last = std::span<const double>(loads_).last(recent);
    const double before = median_of(std::span<const double>(loads_).first(loads_.size() - recent));
    const double scatter = scatter_of(std::span<const double>(loads_).first(loads_.size() - recent), before);
    if (std::abs(std::log(median_of(last) / before)) < std::max(0.2, 4.0 * uncertainty(scatter, recent)))
        return;
    loads_.erase(loads_.begin(), loads_.end() - static_cast<ptrdiff_t>(recent));
    gain_ = first_gain;
    last_direction_ = 0;
}

bool FrameBudget::decide() {
    const size_t n = loads_.size();
    if (n < fewest_if_urgent) return false;
    median_ = median_of(loads_);
    const double deviation = std::log(median_ / (aim_share * target_ms_));
    const double allowed = std::max(dead_band, 2.5 * uncertainty(scatter_of(loads_, median_), n));
    if (n < fewest && std::abs(deviation) < std::max(urgent, allowed)) return false;
    if (before_ms_ > 0.0 && n >= fewest) {
        if (!given_.empty()) given_.back().ratio = std::max(before_ms_ / median_, 1.0);
        before_ms_ = 0.0;
    }
    if (std::abs(deviation) > allowed) return deviation > 0.0 ? go_coarser(deviation) : go_finer(deviation);
    verdict_ = BudgetVerdict::holding;
    return false;
}

double FrameBudget::error_limit() const {
    return given_.size() < ladder_.size() ? rung_of(ladder_[given_.size()]).error_limit : coarsest_factor;
}

bool FrameBudget::changed(BudgetVerdict verdict) {
    loads_.clear();
    to_pass_ = passed_by_;
    verdict_ = verdict;
    ++changes_;
    return true;
}

/// Moves the error against a deviation of the time, as far as `lowest` or `highest`. False where it stands there already.
bool FrameBudget::scale_error(double deviation, double lowest, double highest) {
    const int direction = deviation > 0.0 ? 1 : -1;
    if (direction == last_direction_) gain_ = std::min(gain_ * 1.3, largest_gain);
    if (direction == -last_direction_) gain_ = std::max(gain_ * 0.5, smallest_gain);
    const double step = std::clamp(gain_ * deviation, -0.7, 0.7);
    const double next = std::clamp(factor_ * std::exp(step), lowest, highest);
    if (std::abs(std::log(next / factor_)) < 0.005) return false;
    factor_ = next;
    last_direction_ = direction;
    return true;
}

bool FrameBudget::go_coarser(double deviation) {
    const double limit = std::max(error_limit(), factor_);
    if (scale_error(deviation, factor_, limit) || give_up_next()) return changed(BudgetVerdict::coarser);
    verdict_ = median_ > target_ms_ ? BudgetVerdict::exhausted : BudgetVerdict::holding;
    return false;
}

bool FrameBudget::give_up_next() {
    if (given_.size() == ladder_.size()) return false;
    const Sacrifice next = ladder_[given_.size()];
    const bool too_early = came_back_ == next && pictures_ - came_back_at_ < at_once;
    patience_ =
        too_early ? std::clamp(patience_ * 2, shortest_patience * 2, longest_patience) : shortest_patience;
    given_.push_back({next, 1.0, pictures_ + patience_});
    before_ms_ = median_;
    gain_ = first_gain;
    last_direction_ = 0;
    return true;
}

/// Whether the layer given up last fits again, with the error at the limit at which it went.
bool FrameBudget::may_take_back() const {
    if (given_.empty() || pictures_ < given_.back().try_after) return false;
    const double limit = rung_of(given_.back().what).error_limit;
    const double by_error = std::min(std::pow(factor_ / limit, certain_elasticity), 1.0);
    return median_ * given_.back().ratio * by_error <= aim_share * target_ms_;
}

bool FrameBudget::take_back_last() {
    came_back_ = given_.back().what;
    came_back_at_ = pictures_;
    factor_ = std::max(factor_, rung_of(given_.back().what).error_limit);
    given_.pop_back();
    before_ms_ = 0.0;
    gain_ = first_gain;
    last_direction_ = 0;
    return true;
}

bool FrameBudget::go_finer(double deviation) {
    if (may_take_back() && take_back_last()) return changed(BudgetVerdict::finer);
    if (scale_error(deviation, 1.0, factor_)) return changed(BudgetVerdict::finer);
    verdict_ = given_.empty() ? BudgetVerdict::all_wanted : BudgetVerdict::holding;
    return false;
}

DrawOptions FrameBudget::apply(const DrawOptions& wanted) const {
    DrawOptions options = wanted;
    const auto factor = static_cast<float>(factor_);
    options.error_px *= factor;
    options.land_error_px *= factor;
    for (const Given& given : given_) take_away(given.what, options);
    return options;
}

BudgetReport FrameBudget::report() const {
    BudgetReport report;
    report.target_ms = target_ms_;
    report.load_ms = median_;
    report.error_factor = factor_;
    for (const Given& given : given_) report.given_up.push_back(given.what);
    report.left_to_give = ladder_.size() - given_.size();
    report.verdict = verdict_;
    report.changes = changes_;
    return report;
}

}  // namespace trochoid
