#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/net/peer_address.hpp"

namespace trochoid {

/// Whom the door lets in, and how far. Pure rules: no sockets, no clocks.
struct DoorPolicy {
    /// Sessions and metrics without TLS for peers that are not on this machine.
    bool allow_plaintext = false;
    /// Origins of web pages that may open a WebSocket ("https://sea.example"), beside those on loopback; "*": any.
    std::vector<std::string> origins;
    /// Host names under which WebSockets and metrics may be asked for, beside loopback names and `addresses`; "*": any.
    std::vector<std::string> hosts;
    /// The addresses bound. An unspecified one (0.0.0.0, ::) stands for every numeric address.
    std::vector<std::string> addresses;
    /// Connections at once of one far address (IPv6: a /64), and of one loopback address; 0: any number.
    uint32_t connections_per_address = 16;
    uint32_t connections_per_loopback_address = 0;
    /// TLS handshakes under way at once; when there are more, the oldest of whoever has most of them goes.
    uint32_t handshakes = 256;
    /// Connections that may be on their way in at once; when there are more, the oldest of whoever has most of them goes.
    uint32_t guests = 4096;
    bool operator==(const DoorPolicy&) const = default;

    /// What a request's Origin and Host say: none of the two names what is not on its list. An empty origin is no browser's.
    bool origin_allowed(std::string_view origin) const;
    bool host_allowed(std::string_view host) const;
    /// Sessions, and metrics, need TLS first.
    bool needs_encryption(const PeerAddress& peer, bool encrypted) const {
        return !encrypted && !peer.loopback && !allow_plaintext;
    }
    /// 0: any number.
    uint32_t most_connections(const PeerAddress& peer) const {
        return peer.loopback ? connections_per_loopback_address : connections_per_address;
    }
};

}  // namespace trochoid
