#pragma once
#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "server/net/peer_address.hpp"

namespace trochoid {

/// Who is somewhere, by address and in the order of coming: when there is no more room, tells who has to make it. No sockets, no
/// clocks. Every call costs the logarithm of how many are there.
class AddressCrowd {
public:
    /// Of two ids the lower is the older one: whoever came to the door first.
    void enter(const PeerAddress& address, uint64_t id);
    /// Without effect where it is not there.
    void leave(const PeerAddress& address, uint64_t id);
    size_t size() const { return size_; }
    /// The oldest of the address with the most; of addresses with as many, the oldest of all. Nothing: nobody is there.
    std::optional<uint64_t> first_to_go() const;

private:
    struct Rank {
        uint64_t all_but;  // descends with the number there
        uint64_t oldest;
        auto operator<=>(const Rank&) const = default;
    };
    static Rank rank_of(const std::set<uint64_t>& ids);

    std::map<PeerAddress, std::set<uint64_t>> by_address_;
    std::map<Rank, PeerAddress> ranks_;  // an id is in one address only: no two are alike
    size_t size_ = 0;
};

}  // namespace trochoid
