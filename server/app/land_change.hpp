#pragma once
#include <cstddef>
#include <limits>
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
    std::vector<Retraced> touched;            ///< ascending; field ids follow on from the world's next_field
    std::vector<Retraced> untouched;          ///< their fields stay as they are
    std::shared_ptr<const WorldState> world;  ///< that it was traced on
    bool tight = false;                       ///< land_is_tight then
};

/// As the world takes it in.
Derived derived_from(const LandOutcome& outcome);

/// Traces these boxes again as far as the edit of the world's terrain can reach. Takes as long as tracing does. `earlier`: what the
/// same edit came to on an earlier state of the world with the same terrain (nullptr: nothing); boxes that are as they
/// were then are not traced again, the result is the same. Errors: too_much_land as soon as more than `most_blocks` have come up.
Result<LandOutcome> trace_edit(const std::shared_ptr<const WorldState>& world, TerrainEdit edit,
                               std::span<const BoxId> boxes, const LandSettings& settings,
                               size_t most_blocks = std::numeric_limits<size_t>::max(),
                               const LandOutcome* earlier = nullptr);

/// Whether the outcome, traced on an earlier state, is that of these boxes of this one.
bool still_holds(const LandOutcome& outcome, const WorldState& world, std::span<const BoxId> boxes,
                 const LandSettings& settings);

/// What the event means for this node, all of it derived anew: for a follower of the log (server/app/replay.hpp).
Derived derive(const std::shared_ptr<const WorldState>& world, const LogEvent& event,
               const LandSettings& settings);

}  // namespace trochoid
