#pragma once
#include <cstddef>
#include <deque>
#include <utility>

#include "protocol/codec/codec.hpp"

namespace trochoid {

/// Small messages on their way to one client: bounded by number and bytes, first in, first out. Frames, headers included.
class ControlLane {
public:
    static constexpr size_t most_bytes = 16 * 1024;

    explicit ControlLane(size_t most_messages) : most_messages_(most_messages) {}

    bool empty() const { return frames_.empty(); }
    bool half_full() const { return 2 * frames_.size() >= most_messages_ || 2 * bytes_ >= most_bytes; }
    /// False where the lane is full: the client takes nothing, and the session ends.
    bool push(Bytes frame) {
        if (frames_.size() >= most_messages_ || bytes_ + frame.size() > most_bytes) return false;
        bytes_ += frame.size();
        frames_.push_back(std::move(frame));
        return true;
    }
    /// All frames, one after the other: they go out in one write. Adds their number to `frames`.
    Bytes take_all(uint64_t& frames) {
        Bytes joined;
        joined.reserve(bytes_);
        for (const Bytes& frame : frames_) joined.insert(joined.end(), frame.begin(), frame.end());
        frames += frames_.size();
        clear();
        return joined;
    }
    void clear() {
        frames_.clear();
        bytes_ = 0;
    }

private:
    size_t most_messages_;
    size_t bytes_ = 0;
    std::deque<Bytes> frames_;
};

}  // namespace trochoid
