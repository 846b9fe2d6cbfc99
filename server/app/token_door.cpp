#include "server/app/token_door.hpp"

#include <chrono>
#include <optional>
#include <utility>

namespace trochoid {

namespace {

Error refused(const char* sentence) { return {ErrorCode::token_refused, sentence}; }

Result<Done> taken(SpentNonces::Outcome outcome) {
    switch (outcome) {
        case SpentNonces::Outcome::first_time: return Done{};
        case SpentNonces::Outcome::used_before:
            return refused(
                "this login was used already and is good for one connection: make a new token for each");
        case SpentNonces::Outcome::too_old:
            return refused(
                "this login's time is over by what this server's clock has been: make a new token");
        case SpentNonces::Outcome::full: break;
    }
    return refused("this server can remember no more used logins at the moment: try again in a minute");
}

}  // namespace

UnixSeconds unix_now() {
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    return {static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::seconds>(since).count())};
}

TokenDoor::TokenDoor(TokenKeys keys, TicketKey ticket_key, ViewerTokens viewers, Clock clock)
    : keys_(std::move(keys)),
      ticket_key_(std::move(ticket_key)),
      viewers_(viewers),
      clock_(std::move(clock)),
      opened_(clock_()) {}

Result<LoginDecision> TokenDoor::by_ticket(const std::vector<uint8_t>& ticket, const WorldInstance& instance,
                                           UnixSeconds now) {
    const Result<ResumeTicket> opened = ticket_key_.open(ticket, instance, now);
    if (!opened) return opened.error();
    SpentNonces& spent = opened->role == Role::viewer ? spent_viewer_tickets_ : spent_tickets_;
    const Result<Done> first = taken(spent.spend(opened->nonce, opened->expiry, now));
    if (!first) return first.error();
    return LoginDecision{opened->role, opened->session};
}

Result<LoginDecision> TokenDoor::by_token(const std::string& token, const std::string& world,
                                          UnixSeconds now) {
    const Result<LoginToken> checked = keys_.check(token, world, opened_, now);
    if (!checked) return checked.error();
    const Result<Done> first = taken(spent_tokens_.spend(checked->nonce, last_moment(checked->expiry), now));
    if (!first) return first.error();
    return LoginDecision{checked->role, 0};
}

Result<LoginDecision> TokenDoor::login(const ClientHello& hello, bool loopback, const std::string& world,
                                       const WorldInstance& instance) {
    const UnixSeconds now = clock_();
    std::optional<Error> fault;
    if (!hello.ticket.empty()) {
        Result<LoginDecision> decision = by_ticket(hello.ticket, instance, now);
        if (decision) return decision;
        fault = decision.error();
    }
    if (!hello.token.empty()) return by_token(hello.token, world, now);
    const bool open_to_viewers =
        viewers_ == ViewerTokens::never || (viewers_ == ViewerTokens::off_loopback && loopback);
    if (open_to_viewers) return LoginDecision{};
    if (fault) return *fault;
    return Error{ErrorCode::token_required,
                 "viewers need a token here: have one made with trochoid-ctl token make --role viewer"};
}

IssuedTicket TokenDoor::new_ticket(uint64_t session, Role role, const WorldInstance& instance) const {
    const UnixSeconds now = clock_();
    const ResumeTicket ticket{role, session, instance, now, {now.value + ticket_life}, random_nonce()};
    constexpr auto life_ms = static_cast<uint32_t>(ticket_life * 1000);
    return {ticket_key_.seal(ticket), life_ms};
}

}  // namespace trochoid
