#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/net/door_guest.hpp"
#include "server/net/peer_address.hpp"

namespace trochoid {

/// The server's one port, on the io thread: tells by a connection's first bytes whether it is TLS, HTTP or raw (inside TLS
/// again), answers HTTP, and hands raw streams and WebSockets to the sessions, as one and the same byte stream.
class FrontDoor {
public:
    /// `tls`: nullptr: none; outlives the door. `world`: its name, for the metrics.
    FrontDoor(IoLoop& loop, SessionServer& sessions, const Limits& limits, DoorPolicy policy,
              const TlsIdentity* tls, std::string world);
    FrontDoor(const FrontDoor&) = delete;
    FrontDoor& operator=(const FrontDoor&) = delete;

    void accept(std::unique_ptr<Transport> transport);
    /// The scene is open: /readyz says so.
    void set_ready() { around_.ready = true; }
    /// /readyz says 503 from here on; connections still come in.
    void begin_draining() { around_.draining = true; }
    /// Whoever is not in yet is let go.
    void close();

    const DoorStats& stats() const { return around_.stats; }
    /// The Prometheus text of /metrics.
    std::string metrics() const;

private:
    void sweep();
    void forget(uint64_t id);
    void close_at_once(std::unique_ptr<Transport> transport, ErrorCode code);

    std::vector<uint8_t> read_buffer_;
    DoorSurroundings around_;
    std::string world_;
    AddressCounts addresses_;
    LoopTimer sweep_timer_;
    std::map<uint64_t, std::shared_ptr<Guest>> guests_;
    uint64_t next_id_ = 1;
    uint32_t beyond_limit_now_ = 0;
};

/// One line for the log.
std::string text_of(const DoorStats& stats);

}  // namespace trochoid
