#include "server/interest/cull_key.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/interest/patch_selection.hpp"

namespace trochoid {

namespace {

bool same_demands(const ViewState& a, const ViewState& b) {
    return a.tan_half_width == b.tan_half_width && a.tan_half_height == b.tan_half_height &&
           a.viewport_width == b.viewport_width && a.viewport_height == b.viewport_height &&
           a.accepted_error_px == b.accepted_error_px && a.patch_budget == b.patch_budget;
}

double square(double v) { return v * v; }

double speed_of(const ViewState& v) { return std::sqrt(square(v.vx) + square(v.vy) + square(v.vz)); }

uint32_t slack_for(const ViewState& v, const Motion& motion) {
    const double altitude = to_metres(v.altitude);
    const double slack = std::max({least_slack, std::max(altitude, -altitude) * slack_of_altitude,
                                   speed_of(v) * std::max(slack_seconds, 2.0 * motion.reaction_s)});
    return static_cast<uint32_t>(to_lattice(slack));
}

float slack_tangent_for(const ViewState& v, const Motion& motion) {
    const float still = std::min(slack_tangent_default,
                                 slack_tangent_of_lens * std::max(v.tan_half_width, v.tan_half_height));
    const auto turned = static_cast<float>(2.0 * motion.turn * motion.reaction_s);
    return std::max(still, std::min(turned, widest_slack_tangent));
}

Motion within_bounds(const Motion& motion) {
    return {std::clamp(motion.reaction_s, 0.0, longest_reaction), std::clamp(motion.turn, 0.0, fastest_turn)};
}

/// Of what the key allows, what may be used up before the next one is chosen: the rest lasts until its result is there. A
/// quarter at least: a camera too fast for its network is not helped by a result for every view.
double share_to_use(const CullKey& key, const ViewState& view, const Motion& motion) {
    const double way = speed_of(view) * motion.reaction_s / std::max(to_metres(key.slack), 1.0);
    const double turned =
        motion.turn * motion.reaction_s / std::max(static_cast<double>(key.slack_tangent), 1e-3);
    return std::max(0.25, std::min(renewal_share, 1.0 - std::max(way, turned)));
}

CullKey with_error(const CullKey& key, float error) {
    CullKey other = key;
    other.error_in_force_px = error;
    return other;
}

/// To the first step of error that fits, or to the first from which patches get no coarser.
void raise_error_until_it_fits(const InterestIndex& index, CullKey& key) {
    if (fits_limit(index, key)) return;
    std::vector<float> steps{key.error_in_force_px};
    while (PatchLod(with_error(key, steps.back())).can_coarsen()) steps.push_back(steps.back() * error_step);
    // More error, fewer patches: the first that fits by halving. The last step counts as fitting, whatever it gives.
    size_t too_fine = 0;
    size_t fits = steps.size() - 1;
    while (fits > too_fine + 1) {
        const size_t middle = (too_fine + fits) / 2;
        (fits_limit(index, with_error(key, steps[middle])) ? fits : too_fine) = middle;
    }
    key.error_in_force_px = steps[fits];
}

/// One step towards the accepted error, where the patches leave room for it.
void lower_error(const InterestIndex& index, CullKey& key) {
    if (key.error_in_force_px <= key.anchor.accepted_error_px) return;
    CullKey finer =
        with_error(key, std::max(key.error_in_force_px / error_step, key.anchor.accepted_error_px));
    finer.patch_limit = static_cast<uint32_t>(refine_below * key.patch_limit);
    if (fits_limit(index, finer)) key.error_in_force_px = finer.error_in_force_px;
}

// Those of the standard's views; an anchor on the wire may be wider.
constexpr float widest_lens = 20.0F;

}  // namespace

bool could_be_chosen(const CullKey& key, int64_t span_us, uint32_t limit) {
    const ViewState& view = key.anchor;
    return view.tan_half_width <= widest_lens && view.tan_half_height <= widest_lens &&
           key.slack >= slack_for(view, {0.0, 0.0}) &&
           key.slack <= slack_for(view, {longest_reaction, 0.0}) &&
           key.slack_tangent >= slack_tangent_for(view, {0.0, 0.0}) &&
           key.slack_tangent <= std::max(widest_slack_tangent, slack_tangent_for(view, {0.0, 0.0})) &&
           key.error_in_force_px >= view.accepted_error_px &&
           key.patch_limit == std::min(view.patch_budget, limit) &&
           key.until - key.from == span_before_us + span_us;
}

bool costs_no_more(const InterestIndex& index, const CullKey& key) {
    return fits_limit(index, key) || !PatchLod(key).can_coarsen();
}

bool within_anchor(const CullKey& key, const ViewState& view, double share) {
    const ViewState& a = key.anchor;
    const double dx = to_metres(view.position.x - a.position.x);
    const double dz = to_metres(view.position.z - a.position.z);
    const double dy = to_metres(int64_t{view.altitude} - a.altitude);
    if (square(dx) + square(dy) + square(dz) > square(to_metres(key.slack) * share)) return false;
    // |p.q| is the cosine of half the turn between two unit quaternions.
    const double dot = static_cast<double>(a.qx) * view.qx + static_cast<double>(a.qy) * view.qy +
                       static_cast<double>(a.qz) * view.qz + static_cast<double>(a.qw) * view.qw;
    const double norms = (square(a.qx) + square(a.qy) + square(a.qz) + square(a.qw)) *
                         (square(view.qx) + square(view.qy) + square(view.qz) + square(view.qw));
    const double cosine = 2.0 * dot * dot / norms - 1.0;
    const double tangent = static_cast<double>(key.slack_tangent) * share;
    return cosine > 0.0 && 1.0 - square(cosine) <= square(tangent * cosine);
}

CullKey choose_key(const InterestIndex& index, const ViewState& view, std::span<const SyncRegion> regions,
                   const CullKey* previous, SeaTime now, int64_t span_us, uint32_t limit,
                   const Motion& asked_motion) {
    const Motion motion = within_bounds(asked_motion);
    CullKey key;
    const bool same_view = previous != nullptr && same_demands(previous->anchor, view) &&
                           within_anchor(*previous, view, share_to_use(*previous, view, motion));
    const bool same_span =
        previous != nullptr && previous->from <= now && now + span_us / 4 <= previous->until;
    const bool same_world = previous != nullptr && previous->log_position == index.log_position();
    if (same_view) {
        key = *previous;
    } else {
        key.anchor = view;
        key.slack = slack_for(view, motion);
        key.slack_tangent = slack_tangent_for(view, motion);
        const bool goes_on = previous != nullptr && same_demands(previous->anchor, view);
        key.error_in_force_px = goes_on ? previous->error_in_force_px : view.accepted_error_px;
    }
    key.patch_limit = std::min(view.patch_budget, limit);
    key.regions.assign(regions.begin(), regions.end());
    key.log_position = index.log_position();
    key.from = same_span ? previous->from : now - span_before_us;
    key.until = same_span ? previous->until : now + span_us;
    if (same_view && same_span && same_world) return key;

    const float before = key.error_in_force_px;
    raise_error_until_it_fits(index, key);
    if (key.error_in_force_px == before) lower_error(index, key);
    return key;
}

}  // namespace trochoid
