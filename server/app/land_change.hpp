#pragma once
#include <memory>
#include <span>
#include <vector>

#include "server/land/land_settings.hpp"
#include "server/world/terrain_edit.hpp"
#include "server/world/world.hpp"

namespace trochoid {

/// What a change of the land comes to before it has a time.
struct LandOutcome {
    TerrainEdit edit;
    std::vector<Retraced> touched;    ///< ascending; field ids follow on from the world's next_field
    std::vector<Retraced> untouched;  ///< their fields stay as they are
};

/// As the world takes it in.
Derived derived_from(const LandOutcome& outcome);

/// Edits the terrain and traces the boxes again as far as the edit can reach. Takes as long as tracing does. Errors: no_terrain, value_out_of_range.
Result<LandOutcome> change_land(const WorldState& world, const ChangeLand& change,
                                std::span<const BoxId> boxes, const LandSettings& settings);

/// What the event means for this node, all of it derived anew: for a follower of the log (server/app/replay.hpp).
Derived derive(const WorldState& world, const LogEvent& event, const LandSettings& settings);

}  // namespace trochoid
