#pragma once
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "protocol/codec/messages.hpp"

namespace trochoid {

/// How a FormServer takes its clients.
struct ServerForm {
    bool tls = false;
    bool web = false;                      ///< WebSocket
    std::string certificate;               ///< PEM
    std::string key;                       ///< PEM
    bool old_tls = false;                  ///< nothing above TLS 1.2
    std::string protocol;                  ///< the only one that ALPN may choose; empty: no ALPN
    std::string subprotocol = "trochoid";  ///< that the answer to an upgrade names; empty: none
};

/// A server of raw streams, TLS, WebSocket or both, that does only what a test tells it. One client at a time; blocking, with a
/// deadline on every wait: at that the client is dropped.
class FormServer {
public:
    using Milliseconds = std::chrono::milliseconds;
    static constexpr Milliseconds patience{5000};

    /// Listens on a free port of 127.0.0.1.
    explicit FormServer(const ServerForm& form);
    FormServer(const FormServer&) = delete;
    FormServer& operator=(const FormServer&) = delete;
    ~FormServer();

    uint16_t port() const;
    /// The next client, with its handshakes; false where one of them fails.
    bool accept(Milliseconds within = patience);
    /// Takes the next client's HTTP request, answers with these bytes and hangs up.
    bool answer_http(const std::string& bytes);
    /// Head of the last HTTP request.
    std::string request() const;
    /// What ALPN chose, and what name the client asked for (SNI).
    std::string chosen_protocol() const;
    std::string asked_name() const;

    /// Accepts, takes the client's hello and answers with this one.
    std::optional<ClientHello> log_in(const ServerHello& hello);
    bool send(const ServerMessage& message);
    /// Bytes of the stream, or one binary message.
    bool send_bytes(std::span<const uint8_t> bytes);
    bool send_text(const std::string& text);
    std::optional<ClientMessage> receive(Milliseconds within = patience);
    template <class Message>
    std::optional<Message> wait_for() {
        while (auto message = receive())
            if (auto* wanted = std::get_if<Message>(&*message)) return std::move(*wanted);
        return std::nullopt;
    }
    /// Reads on until the client ends its side; true where it does so as its form has it (close_notify, close frame).
    bool ends_properly();
    void hang_up();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid
