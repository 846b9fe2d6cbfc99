#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "protocol/units/result.hpp"

namespace trochoid {

/// Places to compare, drawn by a seed: each in a patch with boxes, or in a region where there is no such patch. None where there is
/// neither.
std::vector<LatticePoint> probe_points(const InterestState& state, const std::vector<SyncRegion>& regions,
                                       uint64_t seed, size_t count);

struct ProbeFinding {
    size_t compared = 0;  ///< points that the server has answered
    std::optional<Desync>
        difference;  ///< the first in order of the points; its sequence is left to the caller
};
/// The server's sums beside those of the state that we hold after the probe's result. value_out_of_range where the reply does not belong
/// to the probe.
Result<ProbeFinding> compare(const ProbeReply& theirs, const Probe& asked, const InterestState& ours);

}  // namespace trochoid
