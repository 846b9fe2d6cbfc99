#include "tests/conformance/framed_stream.hpp"

#include <fmt/format.h>

#include <utility>

#include "protocol/wire/requirements.hpp"

namespace trochoid::conformance {

namespace {

constexpr const char* only_frames = "tries the frames of a plain stream: a WebSocket has none";

}  // namespace

int64_t monotonic_us() {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

FramedStream::FramedStream(std::unique_ptr<Stream> stream, FrameReader::Opening opening, uint32_t longest)
    : stream_(std::move(stream)),
      frames_(opening, longest),
      longest_(longest),
      chunk_(32768),
      read_at_us_(monotonic_us()),
      sent_at_us_(read_at_us_) {}

bool FramedStream::sent(bool taken, size_t bytes) {
    sent_at_us_ = monotonic_us();
    bytes_sent_ += bytes;
    return taken;
}

bool FramedStream::send_magic() { return stream_->keeps_messages() || send_bytes(stream_magic); }

bool FramedStream::send_bytes(std::span<const uint8_t> bytes) {
    if (stream_->keeps_messages()) throw Skipped{only_frames};
    return sent(stream_->write(bytes), bytes.size());
}

bool FramedStream::send_frame(std::span<const uint8_t> payload) {
    if (stream_->keeps_messages()) return sent(stream_->write_message(payload), payload.size());
    return send_bytes(frame(payload));
}

std::optional<Arrived> FramedStream::next_message(Milliseconds within) {
    auto payload = stream_->read_message(within);
    if (!payload) return std::nullopt;
    read_at_us_ = monotonic_us();
    bytes_received_ += payload->size();
    if (payload->size() > longest_)
        throw Failed{
            fmt::format("R-103: a message of {} bytes comes, {} are allowed", payload->size(), longest_)};
    return Arrived{std::move(*payload), read_at_us_};
}

std::optional<Arrived> FramedStream::next(Milliseconds within) {
    if (stream_->keeps_messages()) return next_message(within);
    const Deadline deadline(within);
    while (true) {
        Result<std::optional<Bytes>> payload = frames_.next(unread_);
        if (!payload)
            throw Failed{fmt::format("R-{}: {} (from the program under test)",
                                     requirement_of(payload.error().code), payload.error().message)};
        if (payload->has_value()) return Arrived{std::move(**payload), read_at_us_};
        const size_t count = stream_->read(chunk_, deadline.left());
        if (count == 0) return std::nullopt;
        read_at_us_ = monotonic_us();
        bytes_received_ += count;
        unread_ = std::span<const uint8_t>(chunk_).first(count);
    }
}

Bytes FramedStream::next_bytes(Milliseconds within) {
    if (stream_->keeps_messages()) throw Skipped{only_frames};
    const size_t count = stream_->read(chunk_, within);
    bytes_received_ += count;
    return {chunk_.begin(), chunk_.begin() + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace trochoid::conformance
