#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "protocol/units/result.hpp"

namespace trochoid {

/// What a peer did that its stream forbids, and the number of the requirement it breaks.
struct StreamFault {
    Error error;
    uint16_t requirement = 0;
    bool operator==(const StreamFault&) const = default;
};

/// Bytes that are read and dropped after the last word to a peer, so that it comes to read that; who sends more gets no more of the io
/// thread's time.
inline constexpr size_t most_dropped_bytes = size_t{1} << 20;

/// A byte stream to one peer, as a session sees it; never blocks. TCP, TLS and WebSocket look the same behind it.
class Transport {
public:
    /// What a read or write came to: bytes moved, or why none were.
    struct Moved {
        size_t bytes = 0;
        bool closed = false;  ///< the peer is gone, or the stream broke; bytes is 0
        bool operator==(const Moved&) const = default;
    };

    Transport() = default;
    Transport(const Transport&) = delete;
    Transport& operator=(const Transport&) = delete;
    virtual ~Transport() = default;

    /// "127.0.0.1:50123", for logs and for what is counted by address.
    virtual const std::string& peer() const = 0;

    /// Calls back once when `read` has something to say. At most one call is pending; closing forgets it.
    virtual void when_readable(std::function<void()> ready) = 0;
    /// Calls back once when the stream takes bytes that would leave this machine soon (little is unsent).
    virtual void when_writable(std::function<void()> ready) = 0;
    /// Takes what has arrived; 0 bytes and not closed: nothing yet.
    virtual Moved read(std::span<uint8_t> into) = 0;
    /// Hands over what fits; less than all: try the rest, unchanged, when writable.
    virtual Moved write(std::span<const uint8_t> bytes) = 0;
    /// Tells the peer that nothing more comes, and why where the stream has a word for it; reading goes on.
    virtual void finish(ErrorCode why) = 0;
    /// Ends the stream; pending calls are forgotten.
    virtual void close() = 0;

    /// What the peer did that the stream itself forbids (a text frame, a broken record); nothing is readable from then on.
    virtual std::optional<StreamFault> fault() const { return std::nullopt; }
    /// Payloads longer than this (bytes) are refused before memory is taken, where the stream carries whole messages.
    virtual void set_longest(uint32_t) {}
};

}  // namespace trochoid
