#include "tests/conformance/framed_stream.hpp"

#include <fmt/format.h>

#include <utility>

#include "protocol/wire/requirements.hpp"

namespace trochoid::conformance {

int64_t monotonic_us() {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

FramedStream::FramedStream(std::unique_ptr<Stream> stream, FrameReader::Opening opening, uint32_t longest)
    : stream_(std::move(stream)),
      frames_(opening, longest),
      chunk_(32768),
      read_at_us_(monotonic_us()),
      sent_at_us_(read_at_us_) {}

bool FramedStream::send_bytes(std::span<const uint8_t> bytes) {
    const bool taken = stream_->write(bytes);
    sent_at_us_ = monotonic_us();
    bytes_sent_ += bytes.size();
    return taken;
}

bool FramedStream::send_frame(std::span<const uint8_t> payload) { return send_bytes(frame(payload)); }

std::optional<Arrived> FramedStream::next(Milliseconds within) {
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
    const size_t count = stream_->read(chunk_, within);
    bytes_received_ += count;
    return {chunk_.begin(), chunk_.begin() + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace trochoid::conformance
