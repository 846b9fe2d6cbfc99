#include "protocol/wire/frame.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

uint32_t little_endian_u32(std::span<const uint8_t> b) {
    return uint32_t{b[0]} | (uint32_t{b[1]} << 8) | (uint32_t{b[2]} << 16) | (uint32_t{b[3]} << 24);
}

}  // namespace

std::array<uint8_t, frame_header_bytes> frame_header(uint32_t length) {
    std::array<uint8_t, frame_header_bytes> header{};
    for (size_t i = 0; i < 4; ++i) header[i] = static_cast<uint8_t>(length >> (8 * i));
    return header;
}

Bytes frame(std::span<const uint8_t> payload) {
    TROCHOID_ASSERT(!payload.empty() && payload.size() <= UINT32_MAX, "payload of {} bytes", payload.size());
    const auto header = frame_header(static_cast<uint32_t>(payload.size()));
    Bytes out;
    out.reserve(header.size() + payload.size());
    out.insert(out.end(), header.begin(), header.end());
    out.insert(out.end(), payload.begin(), payload.end());
    return out;
}

FrameReader::FrameReader(Opening opening, uint32_t longest)
    : longest_(longest), magic_left_(opening == Opening::magic ? stream_magic.size() : 0) {}

bool FrameReader::read_magic(std::span<const uint8_t>& input) {
    for (; magic_left_ > 0 && !input.empty(); input = input.subspan(1)) {
        if (input.front() != stream_magic[stream_magic.size() - magic_left_]) {
            error_ =
                Error{ErrorCode::wrong_magic,
                      "the stream does not begin with TROCHOID: speak the protocol's raw form on this port"};
            return false;
        }
        --magic_left_;
    }
    return magic_left_ == 0;
}

bool FrameReader::read_header(std::span<const uint8_t>& input) {
    if (header_read_ == frame_header_bytes) return true;
    const size_t taken = std::min(frame_header_bytes - header_read_, input.size());
    std::copy_n(input.begin(), taken, header_.begin() + static_cast<std::ptrdiff_t>(header_read_));
    header_read_ += taken;
    input = input.subspan(taken);
    if (header_read_ < frame_header_bytes) return false;
    const std::span<const uint8_t> header(header_);
    length_ = little_endian_u32(header.first(4));
    if (little_endian_u32(header.subspan(4)) != 0)
        error_ = Error{ErrorCode::malformed_frame, "the second word of a frame's header is not 0"};
    else if (length_ == 0)
        error_ = Error{ErrorCode::malformed_frame, "a frame's length is 0"};
    else if (length_ > longest_)
        error_ = Error{ErrorCode::frame_too_long,
                       fmt::format("a frame of {} bytes is longer than the limit of {}", length_, longest_)};
    return !error_;
}

Result<std::optional<Bytes>> FrameReader::next(std::span<const uint8_t>& input) {
    const bool in_payload = !error_ && read_magic(input) && read_header(input);
    if (error_) return *error_;
    if (!in_payload) return std::optional<Bytes>{};
    const size_t taken = std::min(length_ - payload_.size(), input.size());
    const size_t arrived = payload_.size() + taken;
    // Not left to the vector, which would double.
    if (arrived > payload_.capacity()) payload_.reserve(std::min<size_t>(length_, arrived + read_ahead));
    payload_.insert(payload_.end(), input.begin(), input.begin() + static_cast<std::ptrdiff_t>(taken));
    input = input.subspan(taken);
    if (payload_.size() < length_) return std::optional<Bytes>{};
    header_read_ = 0;
    return std::optional<Bytes>(std::exchange(payload_, {}));
}

}  // namespace trochoid
