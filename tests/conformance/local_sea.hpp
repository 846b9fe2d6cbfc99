#pragma once
#include <string>

#include "protocol/model/interest_state.hpp"
#include "protocol/model/sea.hpp"

namespace trochoid::conformance {

/// The sea that the records held make up, computed here: boxes, and the land blocks that came with them. `trains` of a box may be cut
/// for what a patch displays.
Sea local_sea(const InterestState& state);
/// The same with only those boxes and trains that a patch names.
Sea local_sea(const InterestState& state, const PatchDescriptor& patch);

/// Nothing where both are equal to the bit; else what differs ("ay 3f800000 instead of 3f800001").
std::string difference_of(const SurfaceSample& theirs, const SurfaceSample& ours);

}  // namespace trochoid::conformance
