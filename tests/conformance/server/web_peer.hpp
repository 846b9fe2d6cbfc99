#pragma once
#include <optional>
#include <string>

#include "tests/conformance/server_trial.hpp"
#include "tests/conformance/web_stream.hpp"

namespace trochoid::conformance::server {

/// How a WebSocket ended.
struct WebEnd {
    uint16_t close_code = 0;           ///< of the close frame; 0: none came
    ErrorCode told = ErrorCode::none;  ///< of the goodbye before it; none: none came
};

/// HTTP and WebSocket by hand over a connection of a trial: what is wrong can be sent, too.
class WebPeer {
public:
    explicit WebPeer(ServerTrial& trial) : peer_(trial.connect(Way::bytes)), target_(trial.target()) {}

    /// Sends a request as it is and gives the answer's head and body, up to the end of the stream.
    std::string request(const std::string& text);
    /// Asks for an upgrade (`web_upgrade`); the answer's head.
    std::string upgrade(const std::string& except = "", const std::string& more = "");
    /// After an upgrade: one frame. `first`: opcode with its bits; `masked` as clients have to.
    void send_frame(uint8_t first, std::span<const uint8_t> payload, bool masked = true);
    void send(const ClientMessage& message) { send_frame(web_last | web_binary, encode(message)); }
    /// The next frame; nothing where none came in time or the stream has ended.
    std::optional<WebMessage> receive();
    /// The next binary message, decoded. Failed where none comes, or none that a server may send.
    ServerMessage receive_message();
    /// The stream ends in time; a close frame is answered.
    WebEnd expect_end();
    FramedStream& stream() { return peer_.stream(); }

private:
    bool read_more();

    ServerPeer& peer_;
    const Target& target_;
    Bytes unread_;
};

}  // namespace trochoid::conformance::server
