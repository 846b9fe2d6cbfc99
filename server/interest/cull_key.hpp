#pragma once
#include <span>

#include "server/interest/interest_index.hpp"

namespace trochoid {

/// How a camera moves while a result is on its way.
struct Motion {
    /// From a view's being taken to its result's being applied: the round trip and the interval between views. Above 0 to
    /// longest_reaction.
    double reaction_s = 0.1;
    double turn = 0.0;  ///< rad/s, at least 0
    bool operator==(const Motion&) const = default;
};
inline constexpr double longest_reaction = 1.0;  // s
inline constexpr double fastest_turn = 20.0;     // rad/s

/// The camera may move this far before a result stops holding: the largest of 8 m, a tenth of the altitude, half a
/// second of its velocity and twice the way that it goes until the next result is there.
inline constexpr double least_slack = 8.0;  // m
inline constexpr double slack_of_altitude = 0.1;
inline constexpr double slack_seconds = 0.5;  // s
/// The camera may turn by this tangent (8.5 degrees), but by no more than this share of the wider half-angle's tangent:
/// else a telescope's padding would cost more than its picture.
inline constexpr float slack_tangent_default = 0.15F;
inline constexpr float slack_tangent_of_lens = 0.25F;
/// A camera that turns gets twice the turn that it makes until the next result is there, up to this (31 degrees).
inline constexpr float widest_slack_tangent = 0.6F;
/// A new key is chosen when this share of slack or tangent is used, or earlier where camera and network are so fast that its
/// result would come too late.
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
                   uint32_t limit = 1024, const Motion& motion = {});

/// Whether choose_key could have chosen it for some view and index, all numbers in the ranges of the standard: what a stranger sends as a
/// key may be anything. What its cull costs then has the bounds of any view's where costs_no_more holds besides.
bool could_be_chosen(const CullKey& key, int64_t span_us = span_default_us, uint32_t limit = 1024);

/// Whether its cull costs no more than those of keys that choose_key makes: its patches fit the limit, or get no coarser.
bool costs_no_more(const InterestIndex& index, const CullKey& key);

/// Whether a camera's place and direction lie within this share (0 to 1) of the key's slack and tangent.
bool within_anchor(const CullKey& key, const ViewState& view, double share);

}  // namespace trochoid
