#pragma once
#include <cstdint>
#include <map>

namespace trochoid {

/// What came to the door since the server started; written on the io thread only. Connections that end here are counted
/// by code in ServerStats::ended, like sessions; HTTP answers by status here.
struct DoorStats {
    uint64_t accepted = 0;    ///< connections
    uint64_t guests_now = 0;  ///< not told apart yet, in a handshake, or being answered
    uint64_t handshakes = 0;  ///< TLS handshakes done
    uint64_t handshakes_now = 0;
    uint64_t handshakes_failed = 0;
    uint64_t handshake_turns = 0;  ///< turns of the loop in which handshakes were begun
    uint64_t made_room = 0;        ///< connections that had to go because newer ones came
    // Streams handed to sessions, by form.
    uint64_t raw = 0;
    uint64_t raw_over_tls = 0;
    uint64_t websocket = 0;
    uint64_t websocket_over_tls = 0;
    std::map<unsigned, uint64_t> http_answers;  ///< by status, upgrades (101) apart
    bool operator==(const DoorStats&) const = default;
};

}  // namespace trochoid
