#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "protocol/login/nonce.hpp"
#include "protocol/login/secret.hpp"
#include "protocol/units/result.hpp"

namespace trochoid {

inline constexpr uint64_t ticket_life = 600;  ///< seconds

/// What a server seals into a ticket for whoever comes back: who it was. Only nodes that have the key can read it.
struct ResumeTicket {
    Role role = Role::viewer;
    uint64_t session = 0;    ///< the number that it had; no two nodes give the same
    WorldInstance instance;  ///< audience: one life of a world
    UnixSeconds issued;
    UnixSeconds expiry;
    Nonce nonce{};
    bool operator==(const ResumeTicket&) const = default;
};

/// AES-256-GCM under a key that the nodes of a world share. One key seals at most 2^32 tickets (their initialisation
/// vectors are random).
class TicketKey {
public:
    static constexpr size_t bytes = 32;

    static TicketKey random();
    /// 64 hexadecimal digits, as `openssl rand -hex 32` writes them. Nothing for anything else.
    static std::optional<TicketKey> from_hex(std::string_view digits);

    /// 93 bytes.
    std::vector<uint8_t> seal(const ResumeTicket& ticket) const;
    /// token_refused and what to do for whatever was not sealed with this key, for another life of the world, and for what
    /// has expired. That it was not used before is for `SpentNonces` to say, afterwards.
    Result<ResumeTicket> open(std::span<const uint8_t> sealed, const WorldInstance& instance,
                              UnixSeconds now) const;

private:
    explicit TicketKey(Secret key) : key_(std::move(key)) {}
    Secret key_;
};

}  // namespace trochoid
