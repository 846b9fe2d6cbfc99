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
    /// `samples` above 1 draws with multisampling. `scale` below 1 draws so much of width and height, without multisampling, and
    /// enlarges it. Throws GraphicsError where the device has no such target.
    RenderTarget(uint32_t width, uint32_t height, uint32_t samples, float scale = 1.0F);
    RenderTarget(const RenderTarget&) = delete;
    RenderTarget& operator=(const RenderTarget&) = delete;
    ~RenderTarget();

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    /// Pixels that passes draw, before they are enlarged.
    uint32_t drawn_width() const { return drawn_width_; }
    uint32_t drawn_height() const { return drawn_height_; }
    void bind() const;
    /// Averages the samples, or enlarges; what follows (overlay, reading) is drawn into one sample a pixel.
    void resolve() const;
    void copy_to_window(uint32_t window_width, uint32_t window_height) const;
    Picture read() const;
    /// Waits until the GPU has drawn all that it was told.
    static void finish();

private:
    uint32_t width_;
    uint32_t height_;
    uint32_t drawn_width_;
    uint32_t drawn_height_;
    uint32_t samples_;
    GLuint drawn_ = 0;                     // framebuffer that passes draw into
    GLuint resolved_ = 0;                  // the same one without multisampling and scale
    GLuint renderbuffers_[3] = {0, 0, 0};  // drawn colour, depth and stencil, resolved colour
};

}  // namespace trochoid
