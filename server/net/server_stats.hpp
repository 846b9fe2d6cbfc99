#pragma once
#include <cstdint>
#include <map>
#include <string>

#include "protocol/model/probe_sum.hpp"
#include "protocol/units/error_code.hpp"
#include "server/net/resume_verdict.hpp"

namespace trochoid {

/// What the sessions did since the server started; written on the io thread only.
struct ServerStats {
    uint64_t connections = 0;       ///< accepted
    uint64_t sessions_started = 0;  ///< past the hello
    uint64_t sessions_now = 0;      ///< connections open now
    uint64_t held_back = 0;         ///< connections that had to wait, as their address logs in too often
    uint64_t frames_in = 0;
    uint64_t bytes_in = 0;
    uint64_t frames_out = 0;
    // Bytes out by lane, frame headers included.
    uint64_t control_bytes = 0;
    uint64_t state_bytes = 0;
    uint64_t answer_bytes = 0;
    uint64_t terrain_bytes = 0;

    uint64_t results = 0;                       ///< written, empty ones included
    uint64_t empty_results = 0;                 ///< only a new key or a marker after terrain
    uint64_t resyncs = 0;                       ///< snapshots because a hash differed
    std::map<ResumeVerdict, uint64_t> resumes;  ///< hellos that wished to go on, by what became of it
    uint64_t probes = 0;                        ///< answered, stale ones included
    uint64_t stale_probes = 0;                  ///< came after their result had been superseded
    std::map<PartKind, uint64_t> desyncs;       ///< told by clients, by where the first difference was
    uint64_t terrain_tiles = 0;
    uint64_t views = 0;
    uint64_t views_superseded = 0;  ///< replaced by a later one before a result was decided from them
    uint64_t commands = 0;
    uint64_t exact_viewers = 0;
    uint64_t approximate_viewers = 0;            ///< computed another sea in the known-answer challenge
    std::map<ErrorCode, uint64_t> ended;         ///< sessions that ended, by code
    std::map<ErrorCode, uint64_t> refused;       ///< commands and requests refused, by code
    std::map<ErrorCode, uint64_t> clients_ends;  ///< how clients say that their last session ended, by code
    bool operator==(const ServerStats&) const = default;
};

/// One line for the log.
std::string text_of(const ServerStats& stats);

}  // namespace trochoid
