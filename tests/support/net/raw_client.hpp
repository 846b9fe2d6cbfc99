#pragma once
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "protocol/codec/messages.hpp"
#include "protocol/model/interest_state.hpp"

namespace trochoid {

/// A client that does only what a test tells it, also what the standard forbids: raw bytes, missing acks, no reading.
/// Blocking, with a deadline on every wait.
class RawClient {
public:
    using Milliseconds = std::chrono::milliseconds;
    static constexpr Milliseconds patience{5000};

    /// Connects to loopback; `receive_buffer` in bytes, 0 = the system's.
    explicit RawClient(uint16_t port, int receive_buffer = 0, const std::string& address = "127.0.0.1");
    RawClient(const RawClient&) = delete;
    RawClient& operator=(const RawClient&) = delete;
    ~RawClient();

    /// False where the server has closed.
    bool send_bytes(std::span<const uint8_t> bytes);
    bool send_magic();
    bool send(const ClientMessage& message);
    /// Magic and hello; then the server's hello, or nothing.
    std::optional<ServerHello> log_in(const ClientHello& hello = usual_hello());
    static ClientHello usual_hello();

    /// The next message; nothing after the deadline or at the end of the stream (see `closed`).
    std::optional<ServerMessage> receive(Milliseconds within = patience);
    /// The next message of this type; others are passed over (deltas are applied on the way, see `state`).
    template <class Message>
    std::optional<Message> wait_for(Milliseconds within = patience) {
        const auto until = std::chrono::steady_clock::now() + within;
        while (auto message = receive(left(until)))
            if (auto* wanted = std::get_if<Message>(&*message)) return std::move(*wanted);
        return std::nullopt;
    }
    /// Takes messages until a result is whole, applies it to `state` and gives its last piece.
    std::optional<Delta> next_result(Milliseconds within = patience);
    bool acknowledge(const Delta& result, std::optional<uint64_t> known_answer = {});
    /// Logs in as usual, takes the first result and acknowledges it.
    std::optional<Delta> enter();
    /// The stream has ended.
    bool closed() const;
    /// Reads until the stream ends; true where it does within the deadline.
    bool ends(Milliseconds within = patience);

    /// What all deltas so far add up to.
    const InterestState& state() const { return state_; }
    /// What an earlier client held, for one that comes back.
    void hold(const InterestState& state) { state_ = state; }
    uint64_t bytes_received() const;
    /// Ends the connection abruptly.
    void disconnect();

private:
    static Milliseconds left(std::chrono::steady_clock::time_point until);
    bool read_more(Milliseconds within);

    struct Impl;
    std::unique_ptr<Impl> impl_;
    InterestState state_;
};

}  // namespace trochoid
