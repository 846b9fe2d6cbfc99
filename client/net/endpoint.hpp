#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace trochoid {

/// Where clients look for a server that is not named.
inline constexpr const char* default_server = "127.0.0.1:7421";

/// Where a server listens.
struct Endpoint {
    std::string host = "127.0.0.1";
    uint16_t port = 0;
    bool operator==(const Endpoint&) const = default;
};

/// "HOST:PORT", "[V6]:PORT"; anything else is an OperatorError that shows an example.
Endpoint parse_endpoint(std::string_view text);
std::string to_text(const Endpoint& endpoint);

}  // namespace trochoid
