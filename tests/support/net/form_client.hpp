#pragma once
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "protocol/codec/messages.hpp"
#include "protocol/wire/frame.hpp"
#include "tests/support/net/byte_pipe.hpp"

namespace trochoid {

/// The four ways to a server.
enum class Form : uint8_t { raw, tls, web, web_tls };
constexpr const char* name_of(Form form) {
    constexpr const char* names[] = {"raw", "tls", "ws", "wss"};
    return names[static_cast<size_t>(form)];
}

/// What an upgrade request says; an empty field is left out.
struct UpgradeWish {
    std::string target = "/";
    std::string host = "localhost";
    std::string origin;
    std::string subprotocol = "trochoid";
    std::string version = "13";
    std::string key = "dGhlIHNhbXBsZSBub25jZQ==";
    std::string further;  ///< more lines, each with its "\r\n"
    std::string text() const;
};

/// One WebSocket frame towards a server.
struct WebFrame {
    uint8_t opcode = 2;  ///< 0 continuation, 1 text, 2 binary, 8 close, 9 ping, 10 pong
    bool last = true;
    bool masked = true;
    uint8_t reserved = 0;  ///< the three reserved bits, 0 to 7
    Bytes payload;
    Bytes bytes() const;
};

/// Speaks the protocol over any of the four forms, and does only what a test tells it. Blocking, with deadlines.
class FormClient {
public:
    using Milliseconds = BytePipe::Milliseconds;

    FormClient(Form form, uint16_t port);
    FormClient(Form form, std::unique_ptr<BytePipe> pipe);

    /// Raw: the magic. Web: the upgrade; false where the answer is another than 101 (see `answer`).
    bool open(const UpgradeWish& wish = {});
    bool send(const ClientMessage& message);
    /// Opening, hello, and the server's hello, or nothing.
    std::optional<ServerHello> log_in();
    /// The next message; nothing at the deadline, at the end of the stream or at a close frame.
    std::optional<ServerMessage> receive(Milliseconds within = BytePipe::patience);
    template <class Message>
    std::optional<Message> wait_for(Milliseconds within = BytePipe::patience) {
        const auto until = std::chrono::steady_clock::now() + within;
        while (std::chrono::steady_clock::now() < until) {
            auto message = receive(within);
            if (!message) return std::nullopt;
            if (auto* wanted = std::get_if<Message>(&*message)) return std::move(*wanted);
        }
        return std::nullopt;
    }
    /// Reads on until the stream ends, and hangs up; true where it ended properly (close frame answered, close_notify).
    bool ends(Milliseconds within = BytePipe::patience);

    BytePipe& pipe() { return *pipe_; }
    /// Head of the answer to the upgrade.
    const std::string& answer() const { return answer_; }
    /// Code of the server's close frame; 0: none has come. And its reason.
    unsigned close_code() const { return close_code_; }
    const std::string& close_reason() const { return close_reason_; }
    /// Payloads of pongs, in order.
    const std::deque<Bytes>& pongs() const { return pongs_; }
    /// Binary messages that came in more than one frame, or masked: a server's does neither here.
    bool odd_frames() const { return odd_frames_; }

private:
    bool web() const { return form_ == Form::web || form_ == Form::web_tls; }
    bool read_more(Milliseconds within);
    std::optional<Bytes> next_payload();
    std::optional<Bytes> next_web_payload();

    Form form_;
    std::unique_ptr<BytePipe> pipe_;
    Bytes arrived_;
    FrameReader frames_{FrameReader::Opening::frames, 1U << 20};
    std::string answer_;
    unsigned close_code_ = 0;
    std::string close_reason_;
    std::deque<Bytes> pongs_;
    bool odd_frames_ = false;
};

}  // namespace trochoid
