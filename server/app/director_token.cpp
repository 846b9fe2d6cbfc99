#include "server/app/director_token.hpp"

#include <fmt/format.h>

#include <fstream>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

constexpr size_t shortest = 8;
constexpr size_t longest = 1024;

// No early way out: how long it takes says nothing about where two tokens differ.
bool equal_in_constant_time(const std::string& secret, const std::string& given) {
    unsigned difference = secret.size() == given.size() ? 0U : 1U;
    for (size_t i = 0; i < given.size(); ++i)
        difference |= static_cast<unsigned>(static_cast<unsigned char>(given[i]) ^
                                            static_cast<unsigned char>(secret[i % secret.size()]));
    return difference == 0U;
}

}  // namespace

DirectorToken::DirectorToken(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    if (!in || !std::getline(in, line))
        throw OperatorError(fmt::format(
            "--director-token-file {}: cannot be read; write a line of {} to {} characters into it, as in: openssl rand -hex 32",
            file.string(), shortest, longest));
    const size_t begin = line.find_first_not_of(" \t\r");
    const size_t end = line.find_last_not_of(" \t\r");
    token_ = begin == std::string::npos ? "" : line.substr(begin, end - begin + 1);
    if (token_.size() < shortest || token_.size() > longest)
        throw OperatorError(
            fmt::format("--director-token-file {}: the first line has {} characters, not {} to {}",
                        file.string(), token_.size(), shortest, longest));
}

Result<Role> DirectorToken::role_for(const std::string& given) const {
    if (given.empty()) return Role::viewer;
    if (!exists())
        return Error{
            ErrorCode::token_refused,
            "this server knows no director's token: start it with --director-token-file FILE, or connect without one"};
    if (!equal_in_constant_time(token_, given))
        return Error{
            ErrorCode::token_refused,
            "this is not the director's token: use the file that the server was started with, or connect without one"};
    return Role::admin;
}

}  // namespace trochoid
