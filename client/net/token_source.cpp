#include "client/net/token_source.hpp"

#include <chrono>
#include <utility>

#include "protocol/login/key_file.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

TokenSource::TokenSource(const TokenWords& words) : world_(words.world) {
    if (!words.token_file.empty() && !words.key_file.empty())
        throw OperatorError("--token-file and --sign-with both log in: give one of them");
    if (!words.world.empty() && words.key_file.empty())
        throw OperatorError("--world says what --sign-with signs for: give both");
    if (!words.token_file.empty()) token_ = read_token(words.token_file, "--token-file");
    if (words.key_file.empty()) return;
    KeptSecret<SigningKey> kept = read_signing_key(words.key_file, "--sign-with");
    key_ = std::move(kept.key);
    warning_ = std::move(kept.warning);
    if (!world_.empty()) token(Role::viewer);  // what is wrong with the name is said now
}

std::string TokenSource::token(Role role, const std::string& world) const {
    if (!key_) return token_;
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    const auto now = static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::seconds>(since).count());
    const LoginToken token{
        role, {now}, {now + usual_token_life}, random_nonce(), world_.empty() ? world : world_};
    if (const Result<Done> good = valid(token); !good)
        throw OperatorError("--sign-with: " + good.error().message + "; say --world NAME");
    return sign_token(token, *key_);
}

}  // namespace trochoid
