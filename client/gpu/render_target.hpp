#pragma once
#include <epoxy/gl.h>

#include <cstdint>
#include <vector>

namespace trochoid {

/// RGB, 8 bits each, rows from the top.
struct Picture {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<uint8_t> rgb;
    bool operator==(const Picture&) const = default;
};

/// What everything is drawn into, in a window or not: colour, float depth and stencil. Windows get a copy; their own depth
/// buffers have no floats.
class RenderTarget {
public:
    /// `samples` above 1 draws with multisampling.
    RenderTarget(uint32_t width, uint32_t height, uint32_t samples);
    RenderTarget(const RenderTarget&) = delete;
    RenderTarget& operator=(const RenderTarget&) = delete;
    ~RenderTarget();

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    void bind() const;
    /// Averages the samples; what follows (overlay, reading) is drawn into one sample a pixel.
    void resolve() const;
    void copy_to_window(uint32_t window_width, uint32_t window_height) const;
    Picture read() const;

private:
    uint32_t width_;
    uint32_t height_;
    uint32_t samples_;
    GLuint drawn_ = 0;                     // framebuffer that passes draw into
    GLuint resolved_ = 0;                  // the same one without multisampling
    GLuint renderbuffers_[3] = {0, 0, 0};  // drawn colour, depth and stencil, resolved colour
};

}  // namespace trochoid
