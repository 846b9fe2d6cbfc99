#pragma once
#include <cstddef>
#include <memory>
#include <span>

#include "protocol/units/result.hpp"
#include "server/world/traced_land.hpp"
#include "server/world/world_state.hpp"

namespace trochoid {
struct Retraced;
}

namespace trochoid {

/// Sea time for which boxes whose decay is over keep their land at most when the land changes, microseconds.
inline constexpr int64_t land_kept_us = 3600 * microseconds_per_second;

/// How much land a world holds, in land blocks; fields that several boxes share are counted once.
struct LandRoom {
    size_t held = 0;
    /// Of these, what stays when all boxes are gone that have fallen still, and those whose place another has taken.
    size_t kept = 0;
    size_t most = 0;  ///< WorldState::most_land_blocks
    /// What boxes hold that have not fallen still, those whose place another takes too: it may be half as much again.
    size_t moving = 0;
    size_t left() const {
        const size_t for_good = kept < most ? most - kept : 0;
        const size_t at_once = moving < most + most / 2 ? most + most / 2 - moving : 0;
        return for_good < at_once ? for_good : at_once;
    }
    bool fits() const { return kept <= most && moving <= most + most / 2; }
    bool operator==(const LandRoom&) const = default;
};

/// What is held, and what could be let go of boxes that have fallen still by `by`.
LandRoom land_room(const WorldState& state, SeaTime by);

/// The same once these boxes have been succeeded over their new land.
LandRoom room_after(const WorldState& state, std::span<const Retraced> touched, SeaTime by);

/// Whether more than half of the room is taken, so that overlays are not left to hide much of each other.
bool land_is_tight(const WorldState& state);

/// The refusal of land for which there is no room.
Error too_much_land(const LandRoom& room);

/// Before `coming` more blocks come for boxes from `now` on: lets boxes with land go that have fallen still by then, the first to fall
/// still first, until there is room.
void make_room_for_land(WorldState& state, size_t coming, SeaTime now);

/// When the land changes at `now`: lets boxes with land go that fell still more than land_kept_us ago, and forgets the traces of boxes
/// that no later change of the land can reach.
void let_go_of_old_land(WorldState& state, SeaTime now);

}  // namespace trochoid
