#pragma once
#include <string_view>
#include <vector>

#include "protocol/login/login_token.hpp"

namespace trochoid {

/// More keys are an operator's mistake.
inline constexpr size_t most_token_keys = 16;

/// The public keys that a server trusts.
class TokenKeys {
public:
    TokenKeys() = default;
    explicit TokenKeys(std::vector<TokenKey> keys) : keys_(std::move(keys)) {}

    bool empty() const { return keys_.empty(); }

    /// What the token says, where it is good for this world now; token_refused and what to do otherwise. `opened`: when
    /// this server began to keep used tokens in mind; older ones are refused, as they may have been used before. Cheap
    /// checks come first; one signature is computed at most, and only for a key that is known. That the token was not used
    /// before is for `SpentNonces` to say, afterwards.
    Result<LoginToken> check(std::string_view text, std::string_view world, UnixSeconds opened,
                             UnixSeconds now) const;

private:
    std::vector<TokenKey> keys_;
};

/// Until when a token may come, with the clocks' differences: as long is its nonce kept.
UnixSeconds last_moment(UnixSeconds expiry);

}  // namespace trochoid
