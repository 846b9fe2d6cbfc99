#pragma once
#include <compare>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace trochoid {

/// What of a peer's address counts: whether it is this machine, and the network that limits are kept for.
struct PeerAddress {
    bool loopback = false;
    bool v6 = false;
    /// IPv4: the address; IPv6: its first 64 bits. Nothing smaller is one customer's, but a telephone has no more: where somebody
    /// is refused, those of a wider network must not count together.
    uint64_t network = 0;
    auto operator<=>(const PeerAddress&) const = default;
};

/// Of "127.0.0.1:50123" or "[::1]:50123", as `Transport::peer` writes it; what is neither counts as one far address.
PeerAddress peer_address(std::string_view peer);

/// The network that one line may have to itself (IPv6: a /56, 256 of the /64): who has to make room, and whose turn it is, goes by that.
/// Neither shuts anybody out, so that neighbours may count together.
constexpr PeerAddress line_of(PeerAddress address) {
    if (address.v6) address.network &= ~uint64_t{0xff};
    return address;
}

/// Whether the text is a numeric IPv4 or IPv6 address without port or brackets, and whether it is a loopback one.
bool is_numeric_address(std::string_view host);
bool is_loopback_address(std::string_view host);

/// Connections open now, by address.
class AddressCounts {
public:
    /// One connection more; it counts until what is returned is gone. Outlives this object.
    std::shared_ptr<void> enter(const PeerAddress& address);
    /// Connections open now.
    uint32_t count(const PeerAddress& address) const;

private:
    using Counts = std::map<PeerAddress, uint32_t>;
    std::shared_ptr<Counts> counts_ = std::make_shared<Counts>();
};

}  // namespace trochoid
