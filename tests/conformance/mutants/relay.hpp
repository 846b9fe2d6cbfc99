#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "client/net/endpoint.hpp"
#include "protocol/codec/codec.hpp"
#include "protocol/wire/frame.hpp"

namespace trochoid::conformance::mutants {

/// One connection through the relay, as a spoiler may use it. Nothing reaches either end but what is put through here.
class Link {
public:
    virtual ~Link() = default;
    /// Bytes as they are.
    virtual void bytes_to_server(std::span<const uint8_t> bytes) = 0;
    virtual void bytes_to_client(std::span<const uint8_t> bytes) = 0;
    /// No more comes: that end reads the stream's end.
    virtual void end_server() = 0;
    virtual void end_client() = 0;
    /// The client's connection is reset, as the server's was; nothing more comes of either.
    virtual void reset_client() = 0;

    /// A payload behind its header, a message as we encode it.
    void to_server(std::span<const uint8_t> payload) { bytes_to_server(frame(payload)); }
    void to_client(std::span<const uint8_t> payload) { bytes_to_client(frame(payload)); }
    void say_to_server(const ClientMessage& message) { to_server(encode(message)); }
    void say_to_client(const ServerMessage& message) { to_client(encode(message)); }
};

/// What becomes of a frame whose header breaks.
enum class HeaderFate : uint8_t {
    pass_on,  ///< it goes on as it is, and all that follows it in this direction too
    swallow,  ///< the header goes, and as many bytes as it announces
    mend,     ///< the word behind the length counts as 0: a frame like others
};

/// What a relay does to one connection. As it is here it changes nothing: every byte and end goes on as it came, whole payloads at a
/// time. All calls of a connection come from one thread.
class Spoiler {
public:
    virtual ~Spoiler() = default;
    /// The first 8 bytes of a raw stream.
    virtual void opening(std::span<const uint8_t> magic, Link& link) { link.bytes_to_server(magic); }
    /// A whole payload of the client, of the server; 8-byte aligned.
    virtual void from_client(Bytes payload, Link& link) { link.to_server(payload); }
    virtual void from_server(Bytes payload, Link& link) { link.to_client(payload); }
    /// A header of the client's with its length and second word; the limit in force was broken, or the word.
    virtual HeaderFate bad_header(uint32_t length, uint32_t word) {
        static_cast<void>(length), static_cast<void>(word);
        return HeaderFate::pass_on;
    }
    /// Bytes of HTTP, WebSocket or TLS, in whatever pieces they come.
    virtual void other_from_client(Bytes bytes, Link& link) { link.bytes_to_server(bytes); }
    virtual void other_from_server(Bytes bytes, Link& link) { link.bytes_to_client(bytes); }
    /// The stream of that end has ended.
    virtual void client_ended(Link& link) { link.end_server(); }
    virtual void server_ended(Link& link) { link.end_client(); }
    virtual void server_reset(Link& link) { link.reset_client(); }
};

using MakeSpoiler = std::function<std::unique_ptr<Spoiler>()>;

/// Listens at a free port of the loopback interface (written to `port_file` where that is named) and relays each connection to `to`
/// through a spoiler of its own, until the program ends; `ready` is called with the port once it listens. OperatorError where it
/// cannot listen.
[[noreturn]] void relay(const Endpoint& to, const MakeSpoiler& make, const std::string& port_file,
                        const std::function<void(uint16_t port)>& ready);

}  // namespace trochoid::conformance::mutants
