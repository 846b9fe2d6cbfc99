#pragma once
#include <cstdint>
#include <map>
#include <string>

#include "tests/support/net/chaos_schedule.hpp"

namespace trochoid {

/// What a simulated life came to.
struct StoryEnd {
    std::string failure;  ///< empty: all is well
    uint64_t connections = 0;
    uint64_t sessions = 0;
    uint64_t resumed = 0;
    uint64_t results = 0;
    uint64_t pieces = 0;
    uint64_t events = 0;
    uint64_t restarts = 0;
    uint64_t cuts = 0;
    uint64_t troubles = 0;                    ///< resyncs and desyncs, of those whose memory rots
    std::map<std::string, uint64_t> resumes;  ///< wishes to go on, by what became of them
    // Bytes that the first connection has delivered, for stories that cut at each.
    uint64_t first_up = 0;
    uint64_t first_down = 0;
};

/// A client, a world of three nodes and a network, all that befalls them drawn from the seed: cuts, stalls, delays, half-open
/// connections, nodes that are killed or drained and come back, a sea that changes, a camera that moves. Then calm, and the client
/// has to hold what one that was never cut holds. `trace`: prints what happens.
StoryEnd seeded_story(uint64_t seed, bool trace);

/// A login and a first result whose connection is cut after so many bytes of a direction; the next one stands.
StoryEnd cut_story(bool up, uint64_t at, CutKind kind);

}  // namespace trochoid
