#pragma once
#include <cstdint>

namespace trochoid {

/// What a TCP socket has sent and received, as the kernel counts it; acknowledgements without data are segments, too.
struct TcpCounts {
    static constexpr uint64_t header_bytes = 52;  ///< IPv4 and TCP with time stamps

    uint64_t bytes_sent = 0;
    uint64_t bytes_received = 0;
    uint64_t segments_sent = 0;
    uint64_t segments_received = 0;
    bool operator==(const TcpCounts&) const = default;

    /// Of both directions, headers included.
    uint64_t on_the_wire() const {
        return bytes_sent + bytes_received + header_bytes * (segments_sent + segments_received);
    }
};

/// The sum over this process's connections to a port of 127.0.0.1 that stand now.
TcpCounts counts_of_connections_to(uint16_t port);

}  // namespace trochoid
