#pragma once
#include <epoxy/gl.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "client/scene/frame_report.hpp"

namespace trochoid {

/// GPU time of each pass of a picture, from timestamps that are read some frames later, so that nobody waits for them.
class PassTimers {
public:
    PassTimers();
    PassTimers(const PassTimers&) = delete;
    PassTimers& operator=(const PassTimers&) = delete;
    ~PassTimers();

    void begin_frame();
    /// Ends the pass before and begins one; at most `most_passes` a frame. `name` must live for ever.
    void begin_pass(const char* name);
    void end_frame();

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

    std::array<Frame, frames_in_flight> frames_;
    uint64_t frame_ = 0;
    std::vector<PassTime> passes_;
    double total_ms_ = 0;
};

}  // namespace trochoid
