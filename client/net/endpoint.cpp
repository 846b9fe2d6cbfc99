#include "client/net/endpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <optional>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

struct Scheme {
    std::string_view name;
    Transport transport;
    uint16_t usual_port;  // 0: has to be given
};
constexpr Scheme schemes[] = {{"tcp", Transport::tcp, 0},
                              {"tls", Transport::tls, 0},
                              {"ws", Transport::ws, 80},
                              {"wss", Transport::wss, 443}};

const Scheme& scheme_of(Transport transport) {
    return *std::find_if(std::begin(schemes), std::end(schemes),
                         [transport](const Scheme& s) { return s.transport == transport; });
}

const Scheme* scheme_called(std::string_view name) {
    const auto same = [name](const Scheme& scheme) {
        return std::equal(name.begin(), name.end(), scheme.name.begin(), scheme.name.end(),
                          [](char given, char wanted) { return (given | 0x20) == wanted; });
    };
    const auto* found = std::find_if(std::begin(schemes), std::end(schemes), same);
    return found == std::end(schemes) ? nullptr : found;
}

/// A name or an IPv4 address; it also travels in HTTP headers, so nothing of an address's other parts may be in it.
bool is_host(std::string_view text) {
    return !text.empty() && std::none_of(text.begin(), text.end(), [](char c) {
        return static_cast<unsigned char>(c) <= 0x20 || c == 0x7f ||
               std::string_view("/\\@?#[]<>\"%:").find(c) != std::string_view::npos;
    });
}

bool is_v6(std::string_view text) {
    return text.find(':') != std::string_view::npos &&
           text.find_first_not_of("0123456789abcdefABCDEF:.") == std::string_view::npos;
}

struct Place {
    std::string_view host;
    std::string_view port;
    bool has_port = false;
};

/// "HOST", "HOST:PORT", "[V6]", "[V6]:PORT" in its parts.
std::optional<Place> place_of(std::string_view text) {
    Place place;
    std::string_view rest;
    if (!text.empty() && text.front() == '[') {
        const size_t end = text.find(']');
        if (end == std::string_view::npos) return std::nullopt;
        place.host = text.substr(1, end - 1);
        rest = text.substr(end + 1);
        if (!is_v6(place.host)) return std::nullopt;
    } else {
        place.host = text.substr(0, std::min(text.find(':'), text.size()));
        rest = text.substr(place.host.size());
        if (!is_host(place.host)) return std::nullopt;
    }
    place.has_port = !rest.empty();
    if (place.has_port && rest.front() != ':') return std::nullopt;
    if (place.has_port) place.port = rest.substr(1);
    return place;
}

/// 1 to 65535 in plain digits.
std::optional<uint16_t> port_of(std::string_view digits) {
    uint16_t port = 0;
    const char* end = digits.data() + digits.size();
    const auto [read, error] = std::from_chars(digits.data(), end, port);
    if (error != std::errc() || read != end || port == 0) return std::nullopt;
    return port;
}

}  // namespace

bool is_encrypted(Transport transport) { return transport == Transport::tls || transport == Transport::wss; }

bool is_web(Transport transport) { return transport == Transport::ws || transport == Transport::wss; }

Endpoint with_encryption(Endpoint endpoint, bool encrypted) {
    if (is_web(endpoint.transport))
        endpoint.transport = encrypted ? Transport::wss : Transport::ws;
    else
        endpoint.transport = encrypted ? Transport::tls : Transport::tcp;
    if (!encrypted) endpoint.ca_file.clear();
    return endpoint;
}

bool keeps_secrets(const Endpoint& endpoint) {
    // A name that only begins like an address (127.example.org) is another machine's.
    const bool numbers = endpoint.host.find_first_not_of("0123456789.") == std::string::npos;
    return is_encrypted(endpoint.transport) || endpoint.host == "localhost" || endpoint.host == "::1" ||
           (numbers && endpoint.host.starts_with("127."));
}

void require_secrecy(const Endpoint& endpoint) {
    if (keeps_secrets(endpoint)) return;
    throw OperatorError(fmt::format(
        "a token would travel to {} in the clear, and whoever listens on the way could use it: connect by {}",
        endpoint.host, to_text(with_encryption(endpoint, true))));
}

Endpoint parse_endpoint(std::string_view text) {
    const auto fail = [text] {
        return OperatorError(
            fmt::format("'{}' is not an address: give HOST:PORT, such as 127.0.0.1:7421 or [::1]:7421, or "
                        "tls://sea.example:7421, ws://sea.example:7421 or wss://sea.example:7421",
                        text));
    };
    const Scheme* scheme = &scheme_of(Transport::tcp);
    std::string_view rest = text;
    if (const size_t end = text.find("://"); end != std::string_view::npos) {
        scheme = scheme_called(text.substr(0, end));
        if (scheme == nullptr) throw fail();
        rest.remove_prefix(end + 3);
        if (rest.ends_with('/')) rest.remove_suffix(1);
    }
    const std::optional<Place> place = place_of(rest);
    if (!place) throw fail();
    const std::optional<uint16_t> port = place->has_port ? port_of(place->port) : scheme->usual_port;
    if (!port || *port == 0) throw fail();
    return {std::string(place->host), *port, scheme->transport};
}

std::string host_and_port(const Endpoint& endpoint) {
    const bool v6 = endpoint.host.find(':') != std::string::npos;
    return v6 ? fmt::format("[{}]:{}", endpoint.host, endpoint.port)
              : fmt::format("{}:{}", endpoint.host, endpoint.port);
}

std::string to_text(const Endpoint& endpoint) {
    const std::string place = host_and_port(endpoint);
    return endpoint.transport == Transport::tcp
               ? place
               : fmt::format("{}://{}", scheme_of(endpoint.transport).name, place);
}

}  // namespace trochoid
