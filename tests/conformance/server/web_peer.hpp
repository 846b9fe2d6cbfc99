#pragma once
#include <optional>
#include <string>

#include "tests/conformance/server_trial.hpp"

namespace trochoid::conformance::server {

/// A message of a WebSocket as it came (RFC 6455): what the first byte's lower half says, and the payload.
struct WebMessage {
    uint8_t opcode = 0;
    Bytes payload;
};
inline constexpr uint8_t web_continuation = 0;
inline constexpr uint8_t web_text = 1;
inline constexpr uint8_t web_binary = 2;
inline constexpr uint8_t web_close = 8;
inline constexpr uint8_t web_ping = 9;
inline constexpr uint8_t web_pong = 10;

/// HTTP and WebSocket by hand over a connection of a trial: what is wrong can be sent, too.
class WebPeer {
public:
    explicit WebPeer(ServerTrial& trial) : peer_(trial.connect()), target_(trial.target()) {}

    /// Sends a request as it is and gives the answer's head and body, up to the end of the stream.
    std::string request(const std::string& text);
    /// Sends a request of an upgrade; the answer's head, with what belongs to it left out by a line `except` and `more` added.
    std::string upgrade(const std::string& except = "", const std::string& more = "");
    /// After an upgrade: one frame. `first`: opcode with its bits; `masked` as clients have to.
    void send_frame(uint8_t first, std::span<const uint8_t> payload, bool masked = true);
    void send(const ClientMessage& message) { send_frame(0x80 | web_binary, encode(message)); }
    /// The next message; nothing where none came in time or the stream has ended.
    std::optional<WebMessage> receive();
    /// The next binary message, decoded. Failed where none comes, or none that a server may send.
    ServerMessage receive_message();
    /// The stream ends in time.
    void expect_end();
    FramedStream& stream() { return peer_.stream(); }

private:
    bool read_more();

    ServerPeer& peer_;
    const Target& target_;
    Bytes unread_;
};

/// "HTTP/1.1 426 ..." gives 426; 0 where it is no answer.
int status_of(const std::string& answer);

}  // namespace trochoid::conformance::server
