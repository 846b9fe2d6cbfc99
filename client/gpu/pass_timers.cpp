#include "client/gpu/pass_timers.hpp"

#include "protocol/units/assert.hpp"

namespace trochoid {

PassTimers::PassTimers() {
    for (Frame& frame : frames_)
        glGenQueries(static_cast<GLsizei>(frame.queries.size()), frame.queries.data());
}

PassTimers::~PassTimers() {
    for (Frame& frame : frames_)
        glDeleteQueries(static_cast<GLsizei>(frame.queries.size()), frame.queries.data());
}

void PassTimers::begin_waited(const char* name) {
    end_waited();
    waited_passes_.push_back({name, 0.0});
    pass_began_ = std::chrono::steady_clock::now();
}

/// Ends the pass before when all of it is done.
void PassTimers::end_waited() {
    glFinish();
    if (waited_passes_.empty()) return;
    waited_passes_.back().ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - pass_began_).count();
}

void PassTimers::begin_frame(bool waiting) {
    // Timestamps of frames that did not wait are of no use to one that did, nor the other way round.
    if (waiting != waiting_) frame_ = 0;
    waiting_ = waiting;
    if (waiting) {
        waited_passes_.clear();
        return;
    }
    Frame& frame = frames_[frame_ % frames_in_flight];
    if (frame_ >= frames_in_flight) read(frame);
    frame.count = 0;
}

void PassTimers::begin_pass(const char* name) {
    if (waiting_) {
        begin_waited(name);
        return;
    }
    Frame& frame = frames_[frame_ % frames_in_flight];
    TROCHOID_ASSERT(frame.count < most_passes, "pass {} is one too many", name);
    glQueryCounter(frame.queries[frame.count], GL_TIMESTAMP);
    frame.names[frame.count++] = name;
}

void PassTimers::end_frame() {
    if (waiting_) {
        end_waited();
        passes_ = waited_passes_;
        total_ms_ = 0.0;
        for (const PassTime& pass : passes_) total_ms_ += pass.ms;
        waited_ = true;
        return;
    }
    const Frame& frame = frames_[frame_ % frames_in_flight];
    glQueryCounter(frame.queries[frame.count], GL_TIMESTAMP);
    ++frame_;
}

void PassTimers::read(const Frame& frame) {
    std::array<GLuint64, most_passes + 1> at{};
    for (size_t i = 0; i <= frame.count; ++i)
        glGetQueryObjectui64v(frame.queries[i], GL_QUERY_RESULT, &at[i]);
    passes_.clear();
    waited_ = false;
    for (size_t i = 0; i < frame.count; ++i)
        passes_.push_back({frame.names[i], static_cast<double>(at[i + 1] - at[i]) * 1e-6});
    total_ms_ = static_cast<double>(at[frame.count] - at[0]) * 1e-6;
}

}  // namespace trochoid
