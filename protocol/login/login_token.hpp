#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "protocol/login/nonce.hpp"
#include "protocol/login/signing_key.hpp"
#include "protocol/units/result.hpp"

namespace trochoid {

inline constexpr size_t longest_token_text = 1024;    ///< characters
inline constexpr size_t longest_audience = 256;       ///< bytes of a world's name
inline constexpr uint64_t longest_token_life = 3600;  ///< seconds from issue to expiry
inline constexpr uint64_t usual_token_life = 60;      ///< seconds, where nobody says
inline constexpr uint64_t clock_skew = 30;            ///< seconds by which two machines' clocks may differ

/// What a signed token says: this role, in this world, once, between these times.
struct LoginToken {
    Role role = Role::viewer;
    UnixSeconds issued;
    UnixSeconds expiry;  ///< after `issued`, by longest_token_life at most
    Nonce nonce{};
    std::string world;  ///< audience: the world's name as its server's hello has it, UTF-8, 1 to 256 bytes
    bool operator==(const LoginToken&) const = default;
};

/// A token as it came: well formed, and nothing is known yet of its signature.
struct SignedToken {
    LoginToken token;
    KeyId key{};
    std::vector<uint8_t> payload;
    Signature signature{};
    bool operator==(const SignedToken&) const = default;
};

/// Whether the values are such as a token may carry; value_out_of_range and what is wrong otherwise.
Result<Done> valid(const LoginToken& token);

/// "trochoid1.<payload>.<signature>", both parts base64url. A token that is not `valid` is our own mistake.
std::string sign_token(const LoginToken& token, const SigningKey& key);

/// Reads any text; token_refused where it is no such token. Times and world are whatever it says.
Result<SignedToken> parse_token(std::string_view text);

/// What is signed: the domain "trochoid-token-v1", a zero byte, and the payload.
std::vector<uint8_t> signed_bytes(std::span<const uint8_t> payload);

}  // namespace trochoid
