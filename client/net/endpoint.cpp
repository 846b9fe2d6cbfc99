#include "client/net/endpoint.hpp"

#include <fmt/format.h>

#include <charconv>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

Endpoint parse_endpoint(std::string_view text) {
    const auto fail = [text] {
        return OperatorError(fmt::format(
            "'{}' is not an address: give HOST:PORT, such as 127.0.0.1:7421 or [::1]:7421", text));
    };
    const size_t colon = text.rfind(':');
    if (colon == std::string_view::npos || colon == 0) throw fail();
    std::string_view host = text.substr(0, colon);
    const std::string_view digits = text.substr(colon + 1);
    if (host.front() == '[') {
        if (host.size() < 3 || host.back() != ']') throw fail();
        host = host.substr(1, host.size() - 2);
    } else if (host.find(':') != std::string_view::npos) {
        throw fail();
    }
    Endpoint endpoint{std::string(host), 0};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), endpoint.port);
    if (error != std::errc() || end != digits.data() + digits.size() || endpoint.port == 0) throw fail();
    return endpoint;
}

std::string to_text(const Endpoint& endpoint) {
    const bool v6 = endpoint.host.find(':') != std::string::npos;
    return v6 ? fmt::format("[{}]:{}", endpoint.host, endpoint.port)
              : fmt::format("{}:{}", endpoint.host, endpoint.port);
}

}  // namespace trochoid
