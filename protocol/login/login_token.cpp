#include "protocol/login/login_token.hpp"

#include <algorithm>
#include <optional>

#include "protocol/login/base64url.hpp"
#include "protocol/login/byte_layout.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

constexpr std::string_view prefix = "trochoid1.";
// With its zero byte: no other use of the key signs bytes that begin like this.
constexpr std::string_view domain{"trochoid-token-v1\0", 18};

// The payload's layout (protocol/README.md, "Login"); integers least significant byte first.
constexpr uint8_t layout_version = 1;
constexpr size_t at_version = 0;
constexpr size_t at_role = 1;
constexpr size_t at_key = 2;
constexpr size_t at_issued = 10;
constexpr size_t at_expiry = 18;
constexpr size_t at_nonce = 26;
constexpr size_t at_world = 42;

Error refused(const char* sentence) { return {ErrorCode::token_refused, sentence}; }

Error malformed() {
    return refused(
        "this is no token of the form trochoid1.PAYLOAD.SIGNATURE: make one with trochoid-ctl token make");
}

bool has_control_characters(std::string_view text) {
    for (size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<uint8_t>(text[i]);
        const bool second_set =
            byte == 0xc2 && i + 1 < text.size() && static_cast<uint8_t>(text[i + 1]) < 0xa0;
        if (byte < 0x20 || byte == 0x7f || second_set) return true;
    }
    return false;
}

std::vector<uint8_t> payload_of(const LoginToken& token, const KeyId& key) {
    std::vector<uint8_t> payload(at_world + token.world.size());
    payload[at_version] = layout_version;
    payload[at_role] = static_cast<uint8_t>(token.role);
    put_array(payload, at_key, key);
    put_u64(payload, at_issued, token.issued.value);
    put_u64(payload, at_expiry, token.expiry.value);
    put_array(payload, at_nonce, token.nonce);
    std::copy(token.world.begin(), token.world.end(), payload.begin() + at_world);
    return payload;
}

Result<SignedToken> from_payload(std::vector<uint8_t> payload) {
    if (payload.size() <= at_world || payload.size() > at_world + longest_audience) return malformed();
    if (payload[at_version] != layout_version)
        return refused("the token is of a later form than this server knows: make one for the older program");
    SignedToken found;
    found.token.role = static_cast<Role>(payload[at_role]);
    found.key = array_at<8>(payload, at_key);
    found.token.issued = {u64_at(payload, at_issued)};
    found.token.expiry = {u64_at(payload, at_expiry)};
    found.token.nonce = array_at<16>(payload, at_nonce);
    found.token.world.assign(payload.begin() + at_world, payload.end());
    if (const Result<Done> good = valid(found.token); !good)
        return Error{ErrorCode::token_refused, good.error().message};
    found.payload = std::move(payload);
    return found;
}

}  // namespace

Result<Done> valid(const LoginToken& token) {
    const auto wrong = [](const char* sentence) { return Error{ErrorCode::value_out_of_range, sentence}; };
    if (token.role > Role::admin) return wrong("a token's role is viewer, director or admin");
    if (token.issued.value > latest_unix_second || token.expiry.value > latest_unix_second)
        return wrong("a token's times are unix seconds up to 2^40");
    if (token.expiry <= token.issued || token.expiry.value - token.issued.value > longest_token_life)
        return wrong("a token is good for 1 to 3600 seconds from its issue");
    if (token.world.empty() || token.world.size() > longest_audience || has_control_characters(token.world))
        return wrong("a token names its world in 1 to 256 bytes without control characters");
    return Done{};
}

std::vector<uint8_t> signed_bytes(std::span<const uint8_t> payload) {
    std::vector<uint8_t> bytes(domain.size() + payload.size());
    std::copy(payload.begin(), payload.end(), std::copy(domain.begin(), domain.end(), bytes.begin()));
    return bytes;
}

std::string sign_token(const LoginToken& token, const SigningKey& key) {
    const Result<Done> good = valid(token);
    TROCHOID_ASSERT(good, "{}", good.error().message);
    const std::vector<uint8_t> payload = payload_of(token, key.public_key().id());
    const Signature signature = key.sign(signed_bytes(payload));
    return std::string(prefix) + base64url(payload) + "." + base64url(signature);
}

Result<SignedToken> parse_token(std::string_view text) {
    if (text.size() > longest_token_text || !text.starts_with(prefix)) return malformed();
    text.remove_prefix(prefix.size());
    const size_t dot = text.find('.');
    if (dot == std::string_view::npos) return malformed();
    std::optional<std::vector<uint8_t>> payload = from_base64url(text.substr(0, dot));
    const std::optional<std::vector<uint8_t>> signature = from_base64url(text.substr(dot + 1));
    if (!payload || !signature || signature->size() != Signature{}.size()) return malformed();
    Result<SignedToken> found = from_payload(*std::move(payload));
    if (found) std::copy(signature->begin(), signature->end(), found->signature.begin());
    return found;
}

}  // namespace trochoid
