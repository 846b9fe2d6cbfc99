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

uint32_t slack_for(const ViewState& v) {
    const double speed = std::sqrt(square(v.vx) + square(v.vy) + square(v.vz));
    const double altitude = to_metres(v.altitude);
    const double slack =
        std::max({least_slack, std::max(altitude, -altitude) * slack_of_altitude, speed * slack_seconds});
    return static_cast<uint32_t>(to_lattice(slack));
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

}  // namespace

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
                   const CullKey* previous, SeaTime now, int64_t span_us, uint32_t limit) {
    CullKey key;
    const bool same_view = previous != nullptr && same_demands(previous->anchor, view) &&
                           within_anchor(*previous, view, renewal_share);
    const bool same_span =
        previous != nullptr && previous->from <= now && now + span_us / 4 <= previous->until;
    const bool same_world = previous != nullptr && previous->log_position == index.log_position();
    if (same_view) {
        key = *previous;
    } else {
        key.anchor = view;
        key.slack = slack_for(view);
        key.slack_tangent =
            std::min(slack_tangent_default,
                     slack_tangent_of_lens * std::max(view.tan_half_width, view.tan_half_height));
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
