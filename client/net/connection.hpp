#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "client/net/client_stream.hpp"
#include "protocol/codec/messages.hpp"

namespace trochoid {

/// Bytes and messages of the protocol: magic and frame headers counted where there are any, the headers of a WebSocket and
/// what TLS adds not.
struct Traffic {
    uint64_t bytes_received = 0;
    uint64_t bytes_sent = 0;
    uint64_t frames_received = 0;
    uint64_t frames_sent = 0;
    bool operator==(const Traffic&) const = default;
};

/// Why a connection ended.
enum class CloseCause : uint8_t {
    server_goodbye,  ///< the server said why; the Goodbye is its own
    refused_server,  ///< the server broke the standard; the Goodbye is what we told it
    closed_here,     ///< we asked for it
    over_our_limit,  ///< what we asked for is more than we can hold; the server has broken nothing
    lost,            ///< no answer, refused or reset; the message says which and what to do
};

/// One connection from dialling to its end, over whichever stream. Lives on a NetLoop: callbacks and all members but
/// `traffic` belong to the loop's thread. Never reconnects; make a new one. Whatever the server sends is either handed
/// on as a valid message that may come at this point of a session, or ends the connection.
class Connection : public std::enable_shared_from_this<Connection> {
public:
    struct Events {
        std::function<void()> connected;
        /// A decoded message and our monotonic clock (microseconds) when its last byte had arrived.
        std::function<void(ServerMessage message, int64_t received_us)> message;
        /// Exactly once, last.
        std::function<void(const Goodbye& goodbye, CloseCause cause)> closed;
    };
    /// A connection is given up when dialling, or then the server's hello, takes longer than this.
    static constexpr std::chrono::seconds patience{5};
    /// Bytes that may wait for a server that does not read.
    static constexpr size_t most_waiting = size_t{256} * 1024;

    /// Over the stream that the endpoint's transport asks for (`stream_to`).
    static std::shared_ptr<Connection> open(NetLoop& loop, const Endpoint& endpoint, Events events);
    /// Over this stream, not dialled yet; the endpoint is for sentences only.
    static std::shared_ptr<Connection> open(NetLoop& loop, const Endpoint& endpoint,
                                            std::shared_ptr<ClientStream> stream, Events events);
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;
    ~Connection();

    /// Queues a message; before the connection stands it waits. Nothing after close.
    void send(const ClientMessage& message);
    /// Says goodbye, gives it a second to leave, closes.
    void close(const Goodbye& goodbye);
    /// Ends because the server broke the standard, or because of a limit of our own (too_much_land): it is told the code, and `closed`
    /// says refused_server or over_our_limit.
    void refuse(const Error& error);
    /// The same where the requirement broken (0: none) is not the one that the code stands for.
    void refuse(const Error& error, uint16_t requirement);
    /// From any thread.
    Traffic traffic() const;

private:
    struct Impl;
    explicit Connection(std::unique_ptr<Impl> impl);
    void dial();
    void start();
    void after(std::chrono::milliseconds delay, void (Connection::*overdue)());
    void no_answer();
    void read_some();
    void take(std::span<const uint8_t> bytes);
    void take_message(std::span<const uint8_t> payload, int64_t now_us);
    void write_some();
    void part(const Goodbye& goodbye, CloseCause cause);
    void part_overdue();
    void refuse(const Error& error, Goodbye goodbye);
    void lose(std::string message);
    void finish(const Goodbye& goodbye, CloseCause cause);
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid
