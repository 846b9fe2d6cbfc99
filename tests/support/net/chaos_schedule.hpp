#pragma once
#include <cstdint>
#include <optional>
#include <vector>

namespace trochoid {

/// From byte `at` on nothing is delivered for so long.
struct Stall {
    uint64_t at = 0;  ///< bytes of the direction delivered before it
    int64_t for_us = 0;
    bool operator==(const Stall&) const = default;
};

enum class CutKind : uint8_t {
    reset,   ///< both peers see the connection reset
    finish,  ///< both peers see an orderly end of the stream
    silence  ///< half-open: both directions fall silent, nobody is told
};

/// After exactly `at` delivered bytes of the direction the connection is over.
struct Cut {
    uint64_t at = 0;
    CutKind kind = CutKind::reset;
    bool operator==(const Cut&) const = default;
};

/// Byte `at` arrives with these bits turned over.
struct Flip {
    uint64_t at = 0;
    uint8_t bits = 1;  ///< not 0
    bool operator==(const Flip&) const = default;
};

/// One direction of a connection. Bytes keep their order whatever happens to them.
struct LinkFaults {
    int64_t delay_us = 0;           ///< one way
    int64_t jitter_us = 0;          ///< added to the delay, 0 to this, drawn for each piece
    uint64_t bytes_per_second = 0;  ///< 0: no limit
    /// Bytes on their way before the first comes back as acknowledged, a round trip later; from then on as many more as were
    /// acknowledged: TCP's slow start (RFC 6928: 14,600 bytes). 0: no limit.
    uint32_t first_window = 0;
    std::optional<Stall> stall;
    std::optional<Cut> cut;
    std::vector<Flip> flips;  ///< by ascending `at`
    bool operator==(const LinkFaults&) const = default;
};

struct ConnectionFaults {
    LinkFaults up;    ///< client to server
    LinkFaults down;  ///< server to client
    bool operator==(const ConnectionFaults&) const = default;
};

/// What happens to connections, as a value: its seed and the number of a connection say everything, so a failure is seen
/// again from the two.
struct ChaosSchedule {
    uint64_t seed = 0;
    ConnectionFaults always;  ///< of every connection
    // Of a thousand connections so many suffer this besides, in a direction and at a byte below `within` that are drawn.
    uint32_t stalls = 0;
    uint32_t cuts = 0;
    uint32_t flips = 0;
    uint32_t delays = 0;
    uint64_t within = 16384;            ///< bytes
    int64_t longest_stall_us = 0;       ///< drawn up to here
    int64_t longest_delay_us = 0;       ///< drawn up to here, each way
    uint64_t spared_from = UINT64_MAX;  ///< connections from this number on only suffer `always`
    bool operator==(const ChaosSchedule&) const = default;
};

/// The faults of connection `number`, counted from 0.
ConnectionFaults faults_of(const ChaosSchedule& schedule, uint64_t number);

}  // namespace trochoid
