#pragma once
#include <span>
#include <string_view>

#include "protocol/model/sea.hpp"
#include "server/event/event_log.hpp"
#include "server/land/land_settings.hpp"
#include "server/world/world.hpp"

namespace trochoid {

/// Where a test build (-DTROCHOID_FAULT_INJECTION) errs by one unit in the last place, as the environment variable TROCHOID_FAULT
/// says: one of the stages' names. Everything computed from it goes wrong too, as after a real fault.
bool fault_in(std::string_view stage);

/// The same float, one unit in the last place away from zero.
float one_ulp_off(float v);

/// Takes in a log's events as server/app/replay.hpp does, and errs on the way. "world": the amplitude of the second train of box 1;
/// "land": one node's gain of the middle block of box 1's first field, by one count.
void replay_spoiled(World& world, std::span<const StoredEvent> events, const LandSettings& settings);
/// "constants": the amplitude of the last train of the last box.
Sea spoiled(const Sea& sea);

}  // namespace trochoid
