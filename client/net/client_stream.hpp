#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "client/net/endpoint.hpp"
#include "client/net/net_loop.hpp"
#include "protocol/units/result.hpp"

namespace trochoid {

/// What a Connection drives: a way for bytes, or for whole messages, to one server and back. Lives on a NetLoop's thread:
/// every call comes from there, and every callback comes there, later than the call that asked for it. One dial, then one
/// read and one write at a time. Whoever implements it owns no deadlines: those are the connection's.
class ClientStream {
public:
    /// An error's message is a sentence for people that says what to do. Its code says which rule of the standard the peer
    /// broke; `none` where it has not: the stream is gone then, and nothing more is read.
    using Dialled = std::function<void(const Result<Done>& outcome)>;
    /// The bytes stand until the callback returns.
    using Arrived = std::function<void(const Result<std::span<const uint8_t>>& bytes)>;
    /// Fewer than were given: the stream broke, which the read explains, as it may still hold the server's goodbye.
    using Written = std::function<void(size_t count)>;

    ClientStream() = default;
    ClientStream(const ClientStream&) = delete;
    ClientStream& operator=(const ClientStream&) = delete;
    virtual ~ClientStream() = default;

    /// Connects, up to where the first byte of the protocol may be written.
    virtual void dial(Dialled done) = 0;
    /// What dialling waits for at the moment, to go before "at HOST:PORT within 5 s": "nothing answered".
    virtual const char* awaits() const = 0;
    /// Some bytes of the stream, or one whole message where it keeps messages apart.
    virtual void read(Arrived done) = 0;
    /// All of these bytes, which stand until `done`; one message where it keeps messages apart.
    virtual void write(std::span<const uint8_t> bytes, Written done) = 0;
    /// Nothing more will be written, and what still comes counts no more: it is read to tell the end, and may be dropped.
    virtual void shut() = 0;
    /// Drops the stream at once, whatever is under way. No callback comes any more; they are let go, as they hold whoever gave
    /// them.
    virtual void close() = 0;

    /// Messages travel one by one, so they come without magic and frame headers (WebSocket); else they are framed.
    virtual bool keeps_messages() const { return false; }
    /// Longest message that may arrive, bytes, from the next read on. For streams that keep messages.
    virtual void set_longest(uint32_t /*bytes*/) {}
};

/// The stream for this endpoint's transport. Programs without sockets (simulations) link their own.
std::shared_ptr<ClientStream> stream_to(NetLoop& loop, const Endpoint& endpoint);

}  // namespace trochoid
