#pragma once
#include <cstdint>
#include <string>
#include <variant>

#include "protocol/codec/messages.hpp"
#include "protocol/login/login_token.hpp"

namespace trochoid {

/// `trochoid-ctl token`: keys and tokens, without a server.
struct NewKey {
    std::string file;  ///< the private key; the public one goes to file.pub
    bool operator==(const NewKey&) const = default;
};
struct MakeToken {
    std::string key_file;
    Role role = Role::viewer;
    std::string world;
    uint64_t life_s = usual_token_life;
    std::string out;  ///< empty: standard output
    bool operator==(const MakeToken&) const = default;
};
struct ShowToken {
    std::string token;     ///< the token, or a file that holds one
    std::string key_file;  ///< public key that checks its signature; empty: it is not checked
    bool operator==(const ShowToken&) const = default;
};
using CtlToken = std::variant<NewKey, MakeToken, ShowToken>;

/// What to print on standard output, and what is doubtful.
struct TokenReport {
    std::string text;
    std::string warning;
    int status = 0;  ///< 1: a token was shown whose signature is not good
};

/// Does it. OperatorError where files are in the way.
TokenReport carry_out(const CtlToken& action, bool json);

/// viewer, director or admin.
const char* name_of(Role role);

}  // namespace trochoid
