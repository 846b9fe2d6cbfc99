#pragma once
#include <map>
#include <memory>
#include <vector>

#include "server/world/world.hpp"

namespace trochoid {

/// Takes an event in; one that does not fit the state is our bug. Log position and hash stay as they are.
void fold(WorldState& state, const LogEvent& event, Derived derived);

/// The box that fell still first, or end() where none has by `now`.
std::map<BoxId, std::shared_ptr<const WorldBox>>::const_iterator first_still(
    const std::map<BoxId, std::shared_ptr<const WorldBox>>& boxes, SeaTime now);

/// How much steeper than on open water the traced land can make the box.
double growth_of(const WaveTrainBox& box, const TracedLand& land);

/// The box's fields and all that lie below them.
std::vector<std::shared_ptr<const LandField>> fields_with_bases(const PreparedBox& box);

}  // namespace trochoid
