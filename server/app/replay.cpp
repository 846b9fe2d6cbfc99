#include "server/app/replay.hpp"

#include <fmt/format.h>

#include <utility>

#include "protocol/codec/codec.hpp"
#include "server/app/land_change.hpp"

namespace trochoid {

Result<Done> replay(World& world, std::span<const StoredEvent> events, const LandSettings& settings) {
    for (const StoredEvent& stored : events) {
        const auto state = world.state();
        if (stored.position != state->log_position ||
            stored.log_hash != chain_hash(state->log_hash, stored.bytes))
            return Error{
                ErrorCode::base_mismatch,
                fmt::format("event {} of the log does not follow on position {} of the world: replay the log "
                            "from its beginning",
                            stored.position.value, state->log_position.value)};
        const auto event = decode_event(stored.bytes);
        if (!event) return event.error();
        Derived derived = derive(state, *event, settings);
        world.apply(*event, stored.bytes, std::move(derived));
    }
    return Done{};
}

}  // namespace trochoid
