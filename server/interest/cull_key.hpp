#pragma once
#include <span>

#include "server/interest/interest_index.hpp"

namespace trochoid {

/// The camera may move this far before a result stops holding: the largest of 8 m, a tenth of the altitude and half a
/// second of its velocity.
inline constexpr double least_slack = 8.0;  // m
inline constexpr double slack_of_altitude = 0.1;
inline constexpr double slack_seconds = 0.5;  // s
/// The camera may turn by this tangent (8.5 degrees), but by no more than this share of the wider half-angle's tangent:
/// else a telescope's padding would cost more than its picture.
inline constexpr float slack_tangent_default = 0.15F;
inline constexpr float slack_tangent_of_lens = 0.25F;
/// A new key is chosen when this share of slack or tangent is used, so that its result arrives before it is needed.
inline constexpr double renewal_share = 0.75;
/// Span of sea time that a key's bounds hold for by default; renewed when a quarter is left.
inline constexpr int64_t span_default_us = int64_t{120} * microseconds_per_second;
/// A key's span begins this much before now, for clients that are behind.
inline constexpr int64_t span_before_us = int64_t{2} * microseconds_per_second;
/// The accepted error in force rises or falls by this factor a step, one step a new key when it falls.
inline constexpr float error_step = 1.125F;
/// It falls only where the finer result would fill no more than this share of the limit.
inline constexpr double refine_below = 0.85;

/// The next cull key of a client. While the camera stays inside the previous key's anchor (and lens, budget and accepted
/// error are the same) only regions, log position and, when it runs out, the span change. Over budget the error in force
/// rises until the patches fit (or until more error no longer makes patches coarser; then cull drops those of lowest
/// priority and counts them). `limit` caps the view's own patch budget.
CullKey choose_key(const InterestIndex& index, const ViewState& view, std::span<const SyncRegion> regions,
                   const CullKey* previous, SeaTime now, int64_t span_us = span_default_us,
                   uint32_t limit = 1024);

/// Whether a camera's place and direction lie within this share (0 to 1) of the key's slack and tangent.
bool within_anchor(const CullKey& key, const ViewState& view, double share);

}  // namespace trochoid
