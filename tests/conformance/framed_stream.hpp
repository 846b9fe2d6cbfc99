#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/wire/frame.hpp"
#include "tests/conformance/stream.hpp"

namespace trochoid::conformance {

/// Our monotonic clock, microseconds since an arbitrary moment.
int64_t monotonic_us();

/// A payload, and our clock when its last byte had arrived.
struct Arrived {
    Bytes payload;
    int64_t at_us = 0;
};

/// Payloads over a stream, for either side; sends whatever it is told to, also what is wrong. A WebSocket has neither magic nor frames:
/// cases that send or read bytes of their own are skipped there.
class FramedStream {
public:
    /// `opening`: what we read (frames from a server, the magic first from a client). `longest`: payload that the other side may send.
    FramedStream(std::unique_ptr<Stream> stream, FrameReader::Opening opening, uint32_t longest);

    /// False where the other side takes nothing more, as below.
    bool send_magic();
    /// As they are.
    bool send_bytes(std::span<const uint8_t> bytes);
    /// The payload behind its header, or as a message.
    bool send_frame(std::span<const uint8_t> payload);
    /// The next frame; nothing where none came in time or the stream has ended. Failed where the bytes break.
    std::optional<Arrived> next(Milliseconds within);
    /// Bytes as they are, whatever comes next; nothing where none came in time or the stream has ended.
    Bytes next_bytes(Milliseconds within);
    void set_longest(uint32_t longest) {
        longest_ = longest;
        frames_.set_longest(longest);
    }

    Stream::State state() const { return stream_->state(); }
    std::string wrong_end() const { return stream_->wrong_end(); }
    bool keeps_messages() const { return stream_->keeps_messages(); }
    /// The stream may end here: no frame is begun.
    bool between_frames() const { return unread_.empty() && frames_.between_frames(); }
    void finish() { stream_->finish(); }
    void abort() { stream_->abort(); }
    /// Of the last byte sent.
    int64_t sent_at_us() const { return sent_at_us_; }
    uint64_t bytes_received() const { return bytes_received_; }
    uint64_t bytes_sent() const { return bytes_sent_; }

private:
    bool sent(bool taken, size_t bytes);
    std::optional<Arrived> next_message(Milliseconds within);

    std::unique_ptr<Stream> stream_;
    FrameReader frames_;
    uint32_t longest_ = 0;
    std::vector<uint8_t> chunk_;
    std::span<const uint8_t> unread_;
    int64_t read_at_us_ = 0;
    int64_t sent_at_us_ = 0;
    uint64_t bytes_received_ = 0;
    uint64_t bytes_sent_ = 0;
};

/// What is left of a wait that began earlier, never below 0.
class Deadline {
public:
    explicit Deadline(Milliseconds within) : until_(std::chrono::steady_clock::now() + within) {}
    Milliseconds left() const {
        const auto now = std::chrono::steady_clock::now();
        return now >= until_ ? Milliseconds(0) : std::chrono::ceil<Milliseconds>(until_ - now);
    }
    bool passed() const { return left().count() == 0; }

private:
    std::chrono::steady_clock::time_point until_;
};

}  // namespace trochoid::conformance
