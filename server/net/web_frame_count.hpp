#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace trochoid {

/// Counts the WebSocket frames of a stream that carry no whole message: pings, pongs and fragments, empty ones included. The library reads
/// them without a word. What breaks WebSocket is not judged here.
class WebFrameCount {
public:
    /// The next bytes of the stream; how many such frames begin in them.
    uint32_t take(std::span<const uint8_t> bytes);

private:
    uint64_t left_ = 0;        // of the payload
    size_t header_read_ = 0;   // bytes of the frame's header
    size_t header_bytes_ = 0;  // with length and mask
    size_t longer_left_ = 0;   // bytes of the longer length
    uint64_t length_ = 0;
};

}  // namespace trochoid
