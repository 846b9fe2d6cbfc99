#pragma once
#include "protocol/codec/messages.hpp"

namespace trochoid {

/// The sums at a probe's points as a state has them. Answers the first points only, at least one, where the parts of all would be more
/// than most_probe_parts; of a point that has more by itself it lists the first.
ProbeReply answer_probe(const InterestState& state, const Probe& probe);

}  // namespace trochoid
