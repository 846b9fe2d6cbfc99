#pragma once
#include <epoxy/gl.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "client/scene/frame_report.hpp"

namespace trochoid {

/// GPU time of each pass of a picture, from timestamps that are read some frames later, so that nobody waits for them. A renderer on
/// the processor draws only when it must, so its timestamps tell nothing: a frame may ask to wait for the end of each pass
/// instead, by the wall clock. That is true for the passes, and makes the picture itself slower.
class PassTimers {
public:
    PassTimers();
    PassTimers(const PassTimers&) = delete;
    PassTimers& operator=(const PassTimers&) = delete;
    ~PassTimers();

    /// `waiting`: each pass is waited for, and passes() are then of this frame.
    void begin_frame(bool waiting = false);
    /// Ends the pass before and begins one; at most `most_passes` a frame. `name` must live for ever.
    void begin_pass(const char* name);
    void end_frame();
    /// Whether the times are those of waiting for each pass.
    bool waited() const { return waited_; }

    /// Of the last frame whose times are known, in order; empty before.
    const std::vector<PassTime>& passes() const { return passes_; }
    double total_ms() const { return total_ms_; }

    static constexpr size_t most_passes = 15;

private:
    static constexpr size_t frames_in_flight = 4;
    struct Frame {
        std::array<GLuint, most_passes + 1> queries{};
        std::array<const char*, most_passes> names{};
        size_t count = 0;
    };
    void read(const Frame& frame);
    void begin_waited(const char* name);
    void end_waited();

    std::array<Frame, frames_in_flight> frames_;
    uint64_t frame_ = 0;
    std::vector<PassTime> passes_;
    double total_ms_ = 0;
    bool waiting_ = false;  // in this frame
    bool waited_ = false;   // in the frame of passes_
    std::vector<PassTime> waited_passes_;
    std::chrono::steady_clock::time_point pass_began_;
};

}  // namespace trochoid
