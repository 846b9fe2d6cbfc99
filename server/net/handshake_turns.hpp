#pragma once
#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "server/net/peer_address.hpp"

namespace trochoid {

/// In what order TLS handshakes begin: the address that has begun the fewest lately goes first, then who came to the door first. So
/// a newcomer passes a flood, however long its queue is. No sockets, no clocks.
class HandshakeTurns {
public:
    /// Of two ids the lower goes first: whoever came to the door first.
    void wait(const PeerAddress& address, uint64_t id);
    /// Waits no longer; without effect where it does not.
    void forget(const PeerAddress& address, uint64_t id);
    bool empty() const { return order_.empty(); }
    /// Whose turn it is; it waits no longer.
    std::optional<uint64_t> next();
    /// What was begun so far is no longer lately: to be called once a second.
    void forget_begun();

private:
    struct Rank {
        uint32_t begun;
        uint64_t oldest;
        auto operator<=>(const Rank&) const = default;
    };
    using Waiting = std::map<PeerAddress, std::set<uint64_t>>;
    Rank rank_of(const Waiting::value_type& waiting) const;
    void drop(Waiting::iterator at, uint64_t id);

    Waiting waiting_;
    std::map<PeerAddress, uint32_t> begun_;
    std::map<Rank, PeerAddress> order_;
};

}  // namespace trochoid
