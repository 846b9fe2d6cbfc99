#pragma once
#include <span>

#include "protocol/units/result.hpp"
#include "server/event/event_log.hpp"
#include "server/land/land_settings.hpp"
#include "server/world/world.hpp"

namespace trochoid {

/// Takes in what the log holds from the world's position on, through the stored bytes alone, tracing the land of every box by
/// itself: the world is then, bit by bit (hash_of), the one that wrote the log. Settings as that one's, but for the threads.
/// The error of bytes that are no event, or whose rolling hash differs.
Result<Done> replay(World& world, std::span<const StoredEvent> events, const LandSettings& settings);

}  // namespace trochoid
