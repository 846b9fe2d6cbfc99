#pragma once
#include <memory>
#include <optional>
#include <string>

#include "protocol/wire/frame.hpp"
#include "tests/conformance/stream.hpp"

// WebSockets by hand (RFC 6455): the kit may have to send what no library would.
namespace trochoid::conformance {

inline constexpr uint8_t web_continuation = 0;
inline constexpr uint8_t web_text = 1;
inline constexpr uint8_t web_binary = 2;
inline constexpr uint8_t web_close = 8;
inline constexpr uint8_t web_ping = 9;
inline constexpr uint8_t web_pong = 10;
/// In a frame's first byte: the last one of its message.
inline constexpr uint8_t web_last = 0x80;

/// A frame as it came: what the first byte's lower half says, and the payload.
struct WebMessage {
    uint8_t opcode = 0;
    Bytes payload;
    bool last = true;
};
/// Of a close frame; 1005 where it has none.
uint16_t close_code_of(const WebMessage& close);

/// The bytes of a frame. `first`: opcode with its bits; `masked` as clients have to.
Bytes web_frame(uint8_t first, std::span<const uint8_t> payload, bool masked = true);
enum class WebRole : uint8_t { client, server };
/// Takes a frame of theirs off the front, unmasked; nothing where it is not whole yet. Failed where they may not send it.
std::optional<WebMessage> take_web_frame(Bytes& unread, WebRole theirs = WebRole::server);
/// The head of a request for an upgrade at this Host, without the header lines that begin with `except` (empty: all), with the line `more`.
std::string web_upgrade(const std::string& host, const std::string& except = "",
                        const std::string& more = "");
/// The answer's head, taken off the front; nothing where it is not whole yet.
std::optional<std::string> take_head(Bytes& unread);
/// "HTTP/1.1 426 ..." gives 426; 0 where it is no answer.
int status_of(const std::string& answer);

/// A WebSocket of the subprotocol, whose messages are payloads. `ended`: by a close frame; one that just stops counts as reset.
class WebStream : public Stream {
public:
    /// Bytes below the messages, as they are. False as write().
    virtual bool write_below(std::span<const uint8_t> bytes) = 0;
    /// Of the other side's close frame: 1005 where it names none, 0 where none has come.
    virtual uint16_t close_code() const = 0;
    /// Payloads of the pongs that have come.
    virtual const std::vector<Bytes>& pongs() const = 0;
};

/// As a client. Failed where the server does not agree.
std::unique_ptr<WebStream> begin_web(std::unique_ptr<Stream> inner, const std::string& host,
                                     Milliseconds within);

/// How a client's upgrade is answered. As it is here: 101.
struct WebAnswer {
    std::string status;  ///< "403 Forbidden", and the connection ends; empty: 101
    std::string except;  ///< header lines left out: those that begin so
    std::string more;    ///< a header line besides
};
/// As a server: reads and judges the client's upgrade, and answers it. Failed where the client may not ask so.
std::unique_ptr<WebStream> accept_web(std::unique_ptr<Stream> inner, const WebAnswer& answer,
                                      Milliseconds within);
/// Judges the head of an upgrade by; its key. Failed where a client may not ask so.
std::string judge_upgrade(const std::string& head);

}  // namespace trochoid::conformance
