#pragma once
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/net/endpoint.hpp"
#include "tests/conformance/case.hpp"

namespace trochoid::conformance {

/// Bytes to and from the program under test: blocking, with a deadline on every wait. One thread at a time.
class Stream {
public:
    enum class State : uint8_t { open, ended, reset };

    Stream() = default;
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;
    virtual ~Stream() = default;

    /// False where the other side takes nothing more.
    virtual bool write(std::span<const uint8_t> bytes) = 0;
    /// Bytes read; 0 where nothing came in time or the stream is no longer open.
    virtual size_t read(std::span<uint8_t> into, Milliseconds within) = 0;
    virtual State state() const = 0;
    /// Where it has stopped without the mark that its kind of stream ends with, or with a wrong one, or does not answer ours: what to
    /// say of it, the requirement first. Empty else, and where it was reset.
    virtual std::string wrong_end() const { return {}; }
    /// Tells the other side that nothing more comes; reading goes on.
    virtual void finish() = 0;
    /// Ends the stream at once with a reset.
    virtual void abort() = 0;

    /// Whole payloads travel one by one, without magic and frame headers (WebSocket): they alone are read and written then.
    virtual bool keeps_messages() const { return false; }
    virtual bool write_message(std::span<const uint8_t> /*payload*/) { return false; }
    virtual std::optional<std::vector<uint8_t>> read_message(Milliseconds /*within*/) { return std::nullopt; }
};

/// Connects over TCP (TCP_NODELAY). Failed where nothing listens.
std::unique_ptr<Stream> connect_tcp(const Endpoint& server, Milliseconds within);

}  // namespace trochoid::conformance
