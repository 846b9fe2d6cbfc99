#pragma once
#include <optional>
#include <string>

#include "protocol/codec/messages.hpp"
#include "protocol/login/signing_key.hpp"

namespace trochoid {

/// The options' words for --help.
inline constexpr const char* sign_with_help =
    "Log in with a fresh token signed by this key file (trochoid-ctl token new-key)";
inline constexpr const char* token_file_help =
    "Log in with the token in this file, which is good once (trochoid-ctl token make)";

/// What a program was given to log in with; empty: not given.
struct TokenWords {
    std::string token_file;  ///< --token-file: a file with a token in its first line
    std::string key_file;    ///< --sign-with: a private key that signs a token for each connection
    std::string world;       ///< --world: what that token is for
    bool operator==(const TokenWords&) const = default;
};

/// Where a client's tokens come from: nowhere, a file, or a key that signs a new one for each connection (a token is good
/// for one).
class TokenSource {
public:
    TokenSource() = default;
    /// Reads the files. OperatorError where they hold something else, and where the words do not go together.
    explicit TokenSource(const TokenWords& words);

    bool signs() const { return key_.has_value(); }
    /// The world that was named; empty: none.
    const std::string& world() const { return world_; }
    /// A sentence for whoever started the program, as where others may read the key; empty: nothing.
    const std::string& warning() const { return warning_; }

    /// For one connection, as this role; the file's is what it is. Empty: no token. `world`: where none was named;
    /// OperatorError where that is no name for a world.
    std::string token(Role role, const std::string& world = {}) const;

private:
    std::string token_;
    std::optional<SigningKey> key_;
    std::string world_;
    std::string warning_;
};

}  // namespace trochoid
