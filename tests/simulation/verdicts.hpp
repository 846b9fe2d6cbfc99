#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/model/view.hpp"
#include "tests/simulation/sim_client.hpp"
#include "tests/simulation/sim_node.hpp"

namespace trochoid {

/// Whether the client holds what the node's sea is for it; else what is wrong.
std::string verdict(const SimClient& client, const SimNode& node, const ViewState& view,
                    const std::vector<SyncRegion>& regions);

/// Of a client that nobody has disturbed: what it must never have had to do.
std::string untroubled(const SimClient& client);

/// Whether a node's counters add up; `at_end`: all have left.
std::string verdict(const SimCounts& counts, bool at_end);

}  // namespace trochoid
