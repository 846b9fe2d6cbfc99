#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/net/address_crowd.hpp"
#include "server/net/door_guest.hpp"
#include "server/net/handshake_turns.hpp"
#include "server/net/peer_address.hpp"

namespace trochoid {

/// The server's one port, on the io thread: tells by a connection's first bytes whether it is TLS, HTTP or raw (inside TLS
/// again), answers HTTP, and hands raw streams and WebSockets to the sessions, as one and the same byte stream, each with its first
/// frame. Nobody can shut the door for others: where too many are on their way in, the oldest of whoever has most of them goes; and
/// handshakes begin in fair turns that leave the loop half of its time.
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
    void make_room(const AddressCrowd& crowd);
    void wants_handshake(uint64_t id);
    void take_turns();
    void pause_turns();
    void handshake_over(uint64_t id);
    void forget(uint64_t id);
    void close_at_once(std::unique_ptr<Transport> transport, ErrorCode code);

    std::vector<uint8_t> read_buffer_;
    DoorSurroundings around_;
    std::string world_;
    AddressCounts addresses_;
    LoopTimer sweep_timer_;
    std::map<uint64_t, std::shared_ptr<Guest>> guests_;
    AddressCrowd crowd_;              // of all guests, by line
    AddressCrowd handshakes_;         // of those that shake hands
    HandshakeTurns handshake_turns_;  // of those that are going to
    LoopTimer turns_timer_;
    bool turns_due_ = false;  // a turn, or the pause behind it, is to come
    int64_t begun_since_us_ = 0;
    uint64_t next_id_ = 1;
    uint32_t beyond_limit_now_ = 0;
};

/// One line for the log.
std::string text_of(const DoorStats& stats);

}  // namespace trochoid
