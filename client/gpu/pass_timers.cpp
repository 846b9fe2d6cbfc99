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

void PassTimers::begin_frame() {
    Frame& frame = frames_[frame_ % frames_in_flight];
    if (frame_ >= frames_in_flight) read(frame);
    frame.count = 0;
}

void PassTimers::begin_pass(const char* name) {
    Frame& frame = frames_[frame_ % frames_in_flight];
    TROCHOID_ASSERT(frame.count < most_passes, "pass {} is one too many", name);
    glQueryCounter(frame.queries[frame.count], GL_TIMESTAMP);
    frame.names[frame.count++] = name;
}

void PassTimers::end_frame() {
    const Frame& frame = frames_[frame_ % frames_in_flight];
    glQueryCounter(frame.queries[frame.count], GL_TIMESTAMP);
    ++frame_;
}

void PassTimers::read(const Frame& frame) {
    std::array<GLuint64, most_passes + 1> at{};
    for (size_t i = 0; i <= frame.count; ++i)
        glGetQueryObjectui64v(frame.queries[i], GL_QUERY_RESULT, &at[i]);
    passes_.clear();
    for (size_t i = 0; i < frame.count; ++i)
        passes_.push_back({frame.names[i], static_cast<double>(at[i + 1] - at[i]) * 1e-6});
    total_ms_ = static_cast<double>(at[frame.count] - at[0]) * 1e-6;
}

}  // namespace trochoid
