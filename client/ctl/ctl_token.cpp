#include "client/ctl/ctl_token.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "protocol/login/key_file.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

using Json = nlohmann::ordered_json;

std::chrono::seconds unix_time() {
    return std::chrono::duration_cast<std::chrono::seconds>(
        std::chrono::system_clock::now().time_since_epoch());
}

template <size_t N>
std::string hex(const std::array<uint8_t, N>& bytes) {
    std::string text;
    for (const uint8_t byte : bytes) text += fmt::format("{:02x}", byte);
    return text;
}

std::string time_text(UnixSeconds time) {
    return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(static_cast<std::time_t>(time.value)));
}

TokenReport make_key(const NewKey& asked) {
    const SigningKey key = SigningKey::generate();
    const std::string shown = asked.file + ".pub";
    if (std::filesystem::exists(asked.file))
        throw OperatorError(
            fmt::format("{} is there already and is not written over: name another file", asked.file));
    write_public_file(shown, key.public_key().pem());
    try {
        write_secret_file(asked.file, key.pem().text());
    } catch (const OperatorError&) {
        std::error_code ignored;
        std::filesystem::remove(shown, ignored);
        throw;
    }
    return {fmt::format("private key {}: whoever has it may change the sea; trochoid-ctl --sign-with {}\n"
                        "public key  {}: trochoid-server --token-key {}\n",
                        asked.file, asked.file, shown, shown),
            {}};
}

TokenReport make_token(const MakeToken& asked) {
    const KeptSecret<SigningKey> kept = read_signing_key(asked.key_file, "--key");
    const auto now = static_cast<uint64_t>(unix_time().count());
    const LoginToken token{asked.role, {now}, {now + asked.life_s}, random_nonce(), asked.world};
    if (const Result<Done> good = valid(token); !good) throw OperatorError(good.error().message);
    const std::string text = sign_token(token, kept.key) + "\n";
    if (asked.out.empty()) return {text, kept.warning};
    replace_secret_file(asked.out, text);
    return {fmt::format("{}: a {}'s token for '{}', good once until {}\n", asked.out, name_of(asked.role),
                        asked.world, time_text(token.expiry)),
            kept.warning};
}

/// "not checked", "good" or "wrong".
const char* signature_word(const SignedToken& found, const std::string& key_file) {
    if (key_file.empty()) return "not checked";
    const TokenKey key = read_token_key(key_file, "--pub");
    return key.id() == found.key && key.signed_this(signed_bytes(found.payload), found.signature) ? "good"
                                                                                                  : "wrong";
}

TokenReport show_token(const ShowToken& asked, bool json) {
    const std::string text =
        asked.token.starts_with("trochoid1.") ? asked.token : read_token(asked.token, "TOKEN");
    const Result<SignedToken> found = parse_token(text);
    if (!found) throw OperatorError("TOKEN: " + found.error().message);
    const LoginToken& token = found->token;
    const std::string signature = signature_word(*found, asked.key_file);
    TokenReport report;
    if (signature == "wrong") report.status = 1;
    const int64_t left = static_cast<int64_t>(token.expiry.value) - unix_time().count();
    if (json) {
        report.text =
            Json{{"role", name_of(token.role)},  {"world", token.world},  {"issued", token.issued.value},
                 {"expiry", token.expiry.value}, {"left_s", left},        {"nonce", hex(token.nonce)},
                 {"key", hex(found->key)},       {"signature", signature}}
                .dump(2, ' ', false, Json::error_handler_t::replace) +
            "\n";
        return report;
    }
    report.text = fmt::format(
        "role       {}\nworld      {}\nissued     {}\nexpires    {} ({})\nnonce      {}\nkey        {}\nsignature  {}{}\n",
        name_of(token.role), token.world, time_text(token.issued), time_text(token.expiry),
        left >= 0 ? fmt::format("in {} s", left) : fmt::format("{} s ago", -left), hex(token.nonce),
        hex(found->key), signature, asked.key_file.empty() ? " (--pub FILE)" : "");
    return report;
}

}  // namespace

const char* name_of(Role role) {
    switch (role) {
        case Role::viewer: return "viewer";
        case Role::director: return "director";
        case Role::admin: return "admin";
    }
    return "unknown";
}

TokenReport carry_out(const CtlToken& action, bool json) {
    if (const auto* asked = std::get_if<NewKey>(&action)) return make_key(*asked);
    if (const auto* asked = std::get_if<MakeToken>(&action)) return make_token(*asked);
    return show_token(std::get<ShowToken>(action), json);
}

}  // namespace trochoid
