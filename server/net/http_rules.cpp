#include "server/net/http_rules.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "server/net/websocket_transport.hpp"

namespace trochoid {

namespace {

bool is_websocket_key(const std::string& key) {
    constexpr size_t length = 24;  // 16 bytes in base64
    const auto base64 = [](char c) {
        return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' ||
               c == '/';
    };
    return key.size() == length && key.ends_with("==") && std::all_of(key.begin(), key.end() - 2, base64);
}

// A page that had its own name point here (DNS rebinding) still sends that name.
HttpAnswer other_host(const HttpRequest& request) {
    return sentence(403, fmt::format("The host '{}' is not on this server's list: ask for it by one of its "
                                     "addresses, or start the server with --allow-host.",
                                     request.host));
}

std::optional<HttpAnswer> upgrade_refusal(const HttpRequest& request, const HttpSituation& situation) {
    if (request.method != "GET") return sentence(405, "A WebSocket is opened with GET.", {"Allow: GET"});
    if (situation.draining)
        return sentence(503, "This server is shutting down: connect again later.", {"Retry-After: 2"});
    if (!situation.policy.host_allowed(request.host)) return other_host(request);
    if (!situation.policy.origin_allowed(request.origin))
        return sentence(403,
                        fmt::format("Pages of '{}' may not connect: start the server with --allow-origin "
                                    "for them.",
                                    request.origin));
    if (request.websocket_version != "13")
        return sentence(426, "WebSocket version 13 is spoken here.",
                        {"Upgrade: websocket", "Connection: Upgrade, close", "Sec-WebSocket-Version: 13"});
    if (!is_websocket_key(request.websocket_key))
        return sentence(400, "Sec-WebSocket-Key has to be 16 bytes in base64.");
    const auto& offered = request.subprotocols;
    if (std::find(offered.begin(), offered.end(), websocket_subprotocol) == offered.end())
        return sentence(400, "Offer the subprotocol: 'Sec-WebSocket-Protocol: trochoid'.");
    return std::nullopt;
}

HttpAnswer readiness(const HttpSituation& situation) {
    if (situation.draining) return sentence(503, "shutting down");
    if (!situation.ready) return sentence(503, "the scene is not open yet");
    return sentence(200, "ready");
}

}  // namespace

bool asks_for_metrics(const HttpRequest& request) { return request.path() == "/metrics"; }

std::optional<HttpAnswer> http_answer_to(const HttpRequest& request, const HttpSituation& situation) {
    if (situation.too_many)
        return sentence(429, "Too many connections from this address: close some, or try again later.",
                        {"Retry-After: 2"});
    if (request.host.empty() && (request.names_host || request.upgrade))
        return sentence(400, "Name the host: 'Host: NAME'.");
    if (request.method != "GET" && request.method != "HEAD")
        return sentence(405, "Only GET and HEAD are answered here.", {"Allow: GET, HEAD"});
    if (request.has_body) return sentence(413, "Requests have no body here.");
    const std::string_view path = request.path();
    if (path == "/livez") return sentence(200, "alive");
    if (path == "/readyz") return readiness(situation);
    if (path == "/metrics") {
        // Who names no host (HTTP/1.0) is no browser.
        if (!request.host.empty() && !situation.policy.host_allowed(request.host)) return other_host(request);
        if (!situation.encrypt) return std::nullopt;
        return sentence(403,
                        "Metrics need TLS from another machine: ask with https, or start the server with "
                        "--allow-plaintext on a network you trust.");
    }
    if (path != "/") return sentence(404, "There are /, /livez, /readyz and /metrics here.");
    if (request.upgrade) return upgrade_refusal(request, situation);
    return sentence(
        426,
        "This is a Trochoid server. Look at the sea with trochoid-viewer --connect HOST:PORT, or open a "
        "WebSocket here with the subprotocol 'trochoid'; /livez, /readyz and /metrics answer plain GETs.",
        {"Upgrade: websocket", "Connection: Upgrade, close"});
}

}  // namespace trochoid
