#include "client/net/stranger.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace trochoid {

std::string printable(std::string_view text, size_t most) {
    std::string out;
    std::copy_if(text.begin(), text.end(), std::back_inserter(out),
                 [](char c) { return c >= 0x20 && c < 0x7f; });
    return out.size() <= most ? out : out.substr(0, most) + "...";
}

std::string who_listens(std::span<const uint8_t> first, const Endpoint& endpoint) {
    const std::string server = to_text(endpoint);
    const auto begins_with = [first](std::string_view beginning) {
        return first.size() >= beginning.size() &&
               std::equal(beginning.begin(), beginning.end(), first.begin(),
                          [](char wanted, uint8_t got) { return static_cast<uint8_t>(wanted) == got; });
    };
    if (begins_with("HTTP/"))
        return fmt::format(
            "a web server listens at {} and does not speak Trochoid's protocol there: check --connect",
            server);
    // A record of TLS: an alert, or a handshake.
    if (begins_with("\x15\x03") || begins_with("\x16\x03"))
        return fmt::format("what listens at {} wants TLS: use --connect {}", server,
                           to_text(with_encryption(endpoint, true)));
    return fmt::format("what listens at {} does not speak Trochoid's protocol: check --connect", server);
}

}  // namespace trochoid
