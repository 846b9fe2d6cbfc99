#include "protocol/login/token_keys.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace trochoid {

namespace {

Error refused(std::string sentence) { return {ErrorCode::token_refused, std::move(sentence)}; }

Result<Done> timely(const LoginToken& token, UnixSeconds opened, UnixSeconds now) {
    if (token.issued.value > now.value + clock_skew)
        return refused("the token is from the future: set the clocks of this server and of who made it");
    if (now > last_moment(token.expiry))
        return refused("the token has expired: make a new one just before connecting");
    if (token.issued < opened)
        return refused("the token is older than this server's run: make a new one just before connecting");
    return Done{};
}

}  // namespace

UnixSeconds last_moment(UnixSeconds expiry) { return {expiry.value + clock_skew}; }

Result<LoginToken> TokenKeys::check(std::string_view text, std::string_view world, UnixSeconds opened,
                                    UnixSeconds now) const {
    if (keys_.empty())
        return refused(
            "this server takes no tokens (it was started without --token-key): connect without one");
    Result<SignedToken> found = parse_token(text);
    if (!found) return found.error();
    if (found->token.world != world)
        return refused(fmt::format("the token is for another world than '{}': make one with --world '{}'",
                                   world, world));
    if (const Result<Done> good = timely(found->token, opened, now); !good) return good.error();
    const auto key = std::find_if(keys_.begin(), keys_.end(),
                                  [&](const TokenKey& known) { return known.id() == found->key; });
    if (key == keys_.end() || !key->signed_this(signed_bytes(found->payload), found->signature))
        return refused(
            "the token is not signed by a key that this server knows: sign with one that its --token-key names");
    return std::move(found->token);
}

}  // namespace trochoid
