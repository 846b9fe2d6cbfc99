#pragma once
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "protocol/codec/messages.hpp"

namespace trochoid {

/// A server that does only what a test tells it, also what the standard forbids. One client at a time; blocking, with a
/// deadline on every wait.
class RawServer {
public:
    using Milliseconds = std::chrono::milliseconds;
    static constexpr Milliseconds patience{5000};

    /// Listens on a free port of 127.0.0.1.
    RawServer();
    RawServer(const RawServer&) = delete;
    RawServer& operator=(const RawServer&) = delete;
    ~RawServer();

    uint16_t port() const;
    /// The next client, in place of the last one; false where none comes.
    bool accept(Milliseconds within = patience);
    /// Accepts, reads magic and hello, answers with the hello given.
    std::optional<ClientHello> log_in(const ServerHello& hello = usual_hello());
    static ServerHello usual_hello();

    bool send_bytes(std::span<const uint8_t> bytes);
    bool send(const ServerMessage& message);
    /// The client's next message; nothing at the deadline or the end of the stream.
    std::optional<ClientMessage> receive(Milliseconds within = patience);
    /// The next message of this type; others are passed over.
    template <class Message>
    std::optional<Message> wait_for(Milliseconds within = patience) {
        const auto until = std::chrono::steady_clock::now() + within;
        while (auto message = receive(left(until)))
            if (auto* wanted = std::get_if<Message>(&*message)) return std::move(*wanted);
        return std::nullopt;
    }
    /// Reads until the client closes; true where it does within the deadline.
    bool ends(Milliseconds within = patience);
    /// Drops the client.
    void hang_up();
    void stop_listening();

private:
    static Milliseconds left(std::chrono::steady_clock::time_point until);
    bool read_more(Milliseconds within);

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid
