#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace trochoid {

/// A request's head up to its empty line: at most this much, as much as a frame before login (bytes).
inline constexpr size_t longest_http_head = 4096;

/// What of an HTTP/1.1 request matters here.
struct HttpRequest {
    std::string method;
    bool names_host = true;  ///< HTTP/1.1, which has to; not so 1.0, as load balancers still speak it
    std::string target;      ///< "/metrics?x=1"
    std::string host;        ///< as sent, maybe with a port; empty: none
    std::string origin;      ///< empty: none
    bool has_body = false;   ///< announced by its length or as chunked
    bool upgrade = false;    ///< asks for WebSocket
    std::string websocket_version;
    std::string websocket_key;
    std::vector<std::string> subprotocols;  ///< in the order of the client's preference

    /// The target without query.
    std::string_view path() const { return std::string_view(target).substr(0, target.find('?')); }
    bool operator==(const HttpRequest&) const = default;
};

/// Why a head was refused: the status to answer with and a sentence.
struct HttpRefusal {
    unsigned status = 400;
    std::string message;
    bool operator==(const HttpRefusal&) const = default;
};

/// Reads a whole head (it ends with an empty line).
std::variant<HttpRequest, HttpRefusal> read_http_head(std::string_view head);

}  // namespace trochoid
