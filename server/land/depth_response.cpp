#include "server/land/depth_response.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/finite_depth.hpp"

namespace trochoid {

namespace {

/// Above any gain that a node can hold.
constexpr double unlimited_gain = 2.0;

/// k D in the deep sea's terms from which on nothing grows as much as unlimited_gain: linear theory reaches it below 0.02, the
/// paper's growth and its decrease never.
constexpr double surely_unbroken = 0.1;

/// Rounded as node depths are, so that "at least as deep" is exact for them.
double as_float(double depth) { return static_cast<double>(static_cast<float>(depth)); }

}  // namespace

DepthResponse::DepthResponse(double turns_per_metre, double open_depth, double height,
                             const LandSettings& settings)
    : shoaling_(settings.shoaling),
      // omega^2 / g = k tanh(k D) in the open sea.
      kd_per_metre_(two_pi_f64 * turns_per_metre * tanh_of(two_pi_f64 * turns_per_metre * open_depth)),
      paper_growth_(settings.growth),
      shore_decrease_(settings.shore_decrease) {
    deep_ = as_float(std::min(1.0 / turns_per_metre, open_depth));
    shallowest_ = as_float(std::min(settings.depth_min, deep_));
    wave_number_at_deep_ = wave_number_ratio(kd_per_metre_ * deep_);
    growth_at_deep_ = shoaling_ratio(kd_per_metre_ * deep_);
    untouched_ = deep_;
    if (settings.breaking_ratio > 0.0 && height > 0.0) {
        breaking_per_metre_ = settings.breaking_ratio / height;
        // In the open sea the box's own height stands, whatever the depth there.
        untouched_ = std::max(deep_, as_float(std::min(open_depth, height / settings.breaking_ratio)));
    }
}

double DepthResponse::wave_number(double depth) const {
    if (depth >= deep_) return 1.0;
    const double ratio =
        wave_number_ratio(kd_per_metre_ * std::max(depth, shallowest_)) / wave_number_at_deep_;
    return std::max(ratio, 1.0);
}

double DepthResponse::growth(double depth) const {
    if (depth >= deep_ || shoaling_ == Shoaling::none) return 1.0;
    const double kd = kd_per_metre_ * std::max(depth, shallowest_);
    if (shoaling_ == Shoaling::linear) return shoaling_ratio(kd) / growth_at_deep_;
    const double starts = std::min(two_pi_f64 * 0.5, kd_per_metre_ * deep_);
    if (shoaling_ == Shoaling::decrease) {
        const double decrease_kd = kd_per_metre_ * std::max(depth, 0.0);
        return decrease_kd < starts ? 1.0 - shore_decrease_ * (1.0 - decrease_kd / starts) : 1.0;
    }
    return kd < starts ? 1.0 + paper_growth_ * (1.0 - kd / starts) : 1.0;
}

double DepthResponse::breaking_gain(double depth) const {
    if (depth <= 0.0) return 0.0;
    if (depth >= untouched_ || breaking_per_metre_ == 0.0) return unlimited_gain;
    return std::min(breaking_per_metre_ * depth, unlimited_gain);
}

double DepthResponse::share_limit(double depth) const {
    if (depth <= 0.0) return 0.0;
    if (all_passes_from(depth)) return 1.0;
    return share_of(breaking_gain(depth), growth(depth));
}

bool DepthResponse::all_passes_from(double depth) const {
    return breaking_gain(depth) >= unlimited_gain && kd_per_metre_ * depth >= surely_unbroken;
}

}  // namespace trochoid
