#include <algorithm>

#include "protocol/login/base64url.hpp"
#include "protocol/login/login_token.hpp"
#include "protocol/login/resume_ticket.hpp"
#include "protocol/login/token_keys.hpp"
#include "server/net/first_bytes.hpp"
#include "server/net/http_request.hpp"
#include "tests/fuzz/allocation_meter.hpp"
#include "tests/fuzz/fuzz_target.hpp"

// What strangers send before anybody knows who they are.
namespace trochoid {

namespace {

void check_http(std::span<const uint8_t> input) {
    const Bytes bytes = owned(input);
    const StreamForm form = form_of(bytes);
    // More bytes never change a decision.
    for (size_t length = 0; length < std::min(bytes.size(), size_t{8}); ++length) {
        const StreamForm early = form_of(std::span(bytes).first(length));
        TROCHOID_ASSERT(early == form || early == StreamForm::undecided,
                        "form {} after {} bytes, {} in the end", static_cast<int>(early), length,
                        static_cast<int>(form));
    }
    TROCHOID_ASSERT(form != StreamForm::undecided || bytes.size() < 3, "undecided after {} bytes",
                    bytes.size());
    const std::string_view head(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const AllocationMeter meter;
    const auto read = read_http_head(head);
    TROCHOID_ASSERT(meter.bytes() <= 65'536 + 64 * bytes.size(), "{} bytes for a head of {}", meter.bytes(),
                    bytes.size());
    if (const auto* refusal = std::get_if<HttpRefusal>(&read)) {
        TROCHOID_ASSERT(refusal->status >= 400 && refusal->status < 600, "status {}", refusal->status);
        TROCHOID_ASSERT(!refusal->message.empty(), "no sentence");
        return;
    }
    const auto& request = std::get<HttpRequest>(read);
    TROCHOID_ASSERT(!request.method.empty() && !request.target.empty(), "no method or target");
    for (const std::string* text : {&request.method, &request.target, &request.host, &request.origin,
                                    &request.websocket_version, &request.websocket_key})
        for (const char c : *text)
            TROCHOID_ASSERT((static_cast<unsigned char>(c) >= 32 && c != 127) || c == '\t',
                            "a control character in '{}'", *text);
    TROCHOID_ASSERT(read_http_head(head) == read, "another request the second time");
}

const SigningKey& our_key() {
    static const SigningKey key = [] {
        constexpr std::array<uint8_t, SigningKey::bytes> seed{1, 2, 3};
        return SigningKey::from_seed(seed);
    }();
    return key;
}

/// A token's text has one form, and none counts that was not signed, or for another world or time.
void check_token(std::string_view text, bool ours) {
    constexpr UnixSeconds opened{1'800'000'000};
    constexpr UnixSeconds now{1'800'000'100};
    static const TokenKeys keys(std::vector<TokenKey>{our_key().public_key()});
    const auto parsed = parse_token(text);
    if (parsed) {
        const std::string again =
            "trochoid1." + base64url(parsed->payload) + "." + base64url(parsed->signature);
        TROCHOID_ASSERT(again == text, "'{}' reads as '{}'", text, again);
        TROCHOID_ASSERT(valid(parsed->token).has_value(), "a token that may not be");
    } else {
        check_refusal(parsed.error());
    }
    const auto checked = keys.check(text, "scilly", opened, now);
    if (!checked) return check_refusal(checked.error());
    TROCHOID_ASSERT(parsed && ours && checked->world == "scilly", "a token of '{}' that we have not signed",
                    checked->world);
    TROCHOID_ASSERT(
        checked->expiry.value + clock_skew >= now.value && checked->issued.value <= now.value + clock_skew,
        "good from {} to {}", checked->issued.value, checked->expiry.value);
}

void check_ticket(InputReader in) {
    static const TicketKey key = *TicketKey::from_hex(std::string(64, '7'));
    ResumeTicket ticket;
    ticket.role = static_cast<Role>(in.byte() % 3);
    ticket.session = in.long_word();
    for (uint8_t& b : ticket.instance.bytes) b = in.byte();
    ticket.issued = {in.word()};
    ticket.expiry = {ticket.issued.value + ticket_life};
    for (uint8_t& b : ticket.nonce) b = in.byte();
    const auto sealed = key.seal(ticket);
    const UnixSeconds later{ticket.issued.value + 1};
    const auto back = key.open(sealed, ticket.instance, later);
    TROCHOID_ASSERT(back.has_value() && *back == ticket, "a ticket does not come back");
    // Whatever else the input is: not one that we have sealed.
    const Bytes forged = owned(in.rest());
    const auto opened = key.open(forged, ticket.instance, later);
    TROCHOID_ASSERT(!opened, "a forged ticket");
    check_refusal(opened.error());
    auto bent = sealed;
    bent[in.rest().size() % bent.size()] ^= 1;
    TROCHOID_ASSERT(!key.open(bent, ticket.instance, later), "a bent ticket");
}

void check_login(std::span<const uint8_t> input) {
    InputReader in(input);
    const uint8_t form = in.byte();
    Bytes rest = owned(in.rest());
    switch (form % 4) {
        case 0: return check_token({reinterpret_cast<const char*>(rest.data()), rest.size()}, false);
        case 1:
        case 2: {
            if (rest.size() > 500) return;  // not a token's length any more
            // The key that it asks for is ours, or what the input says.
            const KeyId id = our_key().public_key().id();
            if (form % 4 == 1 && rest.size() >= 10) std::copy(id.begin(), id.end(), rest.begin() + 2);
            const auto signature = our_key().sign(signed_bytes(rest));
            return check_token("trochoid1." + base64url(rest) + "." + base64url(signature), true);
        }
        default: return check_ticket(InputReader(rest));
    }
}

}  // namespace

const FuzzTarget http_target{"http", check_http, longest_http_head + 64};
const FuzzTarget login_target{"login", check_login, 1200};

}  // namespace trochoid
