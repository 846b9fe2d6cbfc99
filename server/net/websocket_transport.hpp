#pragma once
#include <memory>
#include <string_view>

#include "server/net/http_request.hpp"
#include "server/net/io_loop.hpp"
#include "server/net/transport.hpp"

namespace trochoid {

/// The subprotocol that a client has to offer.
inline constexpr std::string_view websocket_subprotocol = "trochoid";

/// Answers an upgrade request (which names the subprotocol) and makes the WebSocket look like the raw stream: reading
/// gives the magic, then each binary message behind its 8-byte header; each frame written goes out as one binary message.
/// Text messages, messages beyond `longest` bytes (until `set_longest`) and floods of pings or fragments are faults. Pings are answered by the
/// library. What breaks
/// WebSocket itself (masks, opcodes) ends with close code 1002 at once, and is a fault too.
std::unique_ptr<Transport> make_websocket_transport(IoLoop& loop, const HttpRequest& upgrade,
                                                    std::unique_ptr<Transport> inner, uint32_t longest);

}  // namespace trochoid
