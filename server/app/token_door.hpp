#pragma once
#include <functional>
#include <string>

#include "protocol/codec/messages.hpp"
#include "protocol/login/resume_ticket.hpp"
#include "protocol/login/spent_nonces.hpp"
#include "protocol/login/token_keys.hpp"
#include "server/app/viewer_tokens.hpp"
#include "server/net/sea_provider.hpp"

namespace trochoid {

/// This machine's wall clock.
UnixSeconds unix_now();

/// Who comes in, and as what: checks tokens and tickets, and remembers which were used. Directors and admins need a signed
/// token or the ticket that followed one, from wherever they come. On the io thread.
class TokenDoor {
public:
    using Clock = std::function<UnixSeconds()>;

    /// Tokens that are older than this object are refused: it does not know whether they were used.
    TokenDoor(TokenKeys keys, TicketKey ticket_key, ViewerTokens viewers, Clock clock = unix_now);
    TokenDoor(const TokenDoor&) = delete;
    TokenDoor& operator=(const TokenDoor&) = delete;

    /// A good ticket decides alone; else a token does, which then has to be good; else a viewer comes in where viewers need
    /// none. token_required, or token_refused with the token's fault, or the ticket's where it came alone.
    Result<LoginDecision> login(const ClientHello& hello, bool loopback, const std::string& world,
                                const WorldInstance& instance);
    IssuedTicket new_ticket(uint64_t session, Role role, const WorldInstance& instance) const;

    /// False: nobody can become director or admin.
    bool knows_keys() const { return !keys_.empty(); }

private:
    Result<LoginDecision> by_ticket(const std::vector<uint8_t>& ticket, const WorldInstance& instance,
                                    UnixSeconds now);
    Result<LoginDecision> by_token(const std::string& token, const std::string& world, UnixSeconds now);

    TokenKeys keys_;
    TicketKey ticket_key_;
    ViewerTokens viewers_;
    Clock clock_;
    UnixSeconds opened_;
    // Whoever may come in as viewer without a token can use up tickets as fast as it connects: that must not shut out those
    // who have been signed for.
    SpentNonces spent_tokens_;
    SpentNonces spent_tickets_;
    SpentNonces spent_viewer_tickets_;
};

}  // namespace trochoid
