#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "protocol/codec/codec.hpp"
#include "protocol/wire/frame.hpp"

namespace trochoid {

/// A message on its way in, behind room for its frame header. Grows by doubling with what has come, never with what is announced:
/// every byte of it is cleared and copied a few times at most, in however small pieces it comes.
class MessageRoom {
public:
    static constexpr size_t first_step = 512;

    /// Bytes held of the message.
    size_t held() const { return held_; }
    /// Bytes allocated.
    size_t allocated() const { return bytes_.capacity(); }
    /// Where the next bytes go: at least one, and no more than make `most` in all.
    std::span<uint8_t> room(size_t most) {
        const size_t used = frame_header_bytes + held_;
        if (bytes_.size() <= used)
            bytes_.resize(frame_header_bytes + std::min(std::max(2 * held_, first_step), most));
        return std::span(bytes_).subspan(used).first(std::min(bytes_.size() - used, most - held_));
    }
    void took(size_t bytes) { held_ += bytes; }
    /// The message as a frame; nothing of it stays.
    Bytes take_frame() {
        const auto header = frame_header(static_cast<uint32_t>(held_));
        std::copy(header.begin(), header.end(), bytes_.begin());
        bytes_.resize(frame_header_bytes + std::exchange(held_, 0));
        return std::exchange(bytes_, {});
    }
    void clear() {
        bytes_ = {};
        held_ = 0;
    }

private:
    Bytes bytes_;
    size_t held_ = 0;
};

}  // namespace trochoid
