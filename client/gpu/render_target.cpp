#include "client/gpu/render_target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "client/gpu/graphics_error.hpp"

namespace trochoid {

namespace {

void store(GLuint renderbuffer, GLenum format, uint32_t samples, uint32_t width, uint32_t height) {
    glBindRenderbuffer(GL_RENDERBUFFER, renderbuffer);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, static_cast<GLsizei>(samples > 1 ? samples : 0), format,
                                     static_cast<GLsizei>(width), static_cast<GLsizei>(height));
}

uint32_t limit_of(GLenum name) {
    GLint limit = 0;
    glGetIntegerv(name, &limit);
    return static_cast<uint32_t>(std::max(limit, 1));
}

uint32_t scaled(uint32_t length, float scale) {
    const long pixels = std::lround(static_cast<float>(length) * std::clamp(scale, 0.0F, 1.0F));
    return static_cast<uint32_t>(std::max(pixels, 1L));
}

}  // namespace

RenderTarget::RenderTarget(uint32_t width, uint32_t height, uint32_t samples, float scale)
    : width_(width),
      height_(height),
      drawn_width_(scaled(width, scale)),
      drawn_height_(scaled(height, scale)),
      samples_(scale < 1.0F ? 1 : std::min(samples, limit_of(GL_MAX_SAMPLES))) {
    if (const uint32_t most = limit_of(GL_MAX_RENDERBUFFER_SIZE); std::max(width, height) > most)
        throw GraphicsError(fmt::format(
            "This graphics device draws pictures of up to {0} x {0}, not {1} x {2}. Take a smaller --size.",
            most, width, height));
    glGenRenderbuffers(3, renderbuffers_);
    glGenFramebuffers(1, &drawn_);
    store(renderbuffers_[0], GL_RGBA8, samples_, drawn_width_, drawn_height_);
    store(renderbuffers_[1], GL_DEPTH32F_STENCIL8, samples_, drawn_width_, drawn_height_);
    glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, renderbuffers_[0]);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER,
                              renderbuffers_[1]);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw GraphicsError(fmt::format(
            "The graphics device has no room for a picture of {} x {} with {} samples a pixel. Take a smaller "
            "--size or --samples 1.",
            width, height, samples_));
    resolved_ = drawn_;
    if (samples_ > 1 || drawn_width_ != width || drawn_height_ != height) {
        store(renderbuffers_[2], GL_RGBA8, 1, width, height);
        glGenFramebuffers(1, &resolved_);
        glBindFramebuffer(GL_FRAMEBUFFER, resolved_);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, renderbuffers_[2]);
    }
}

RenderTarget::~RenderTarget() {
    if (resolved_ != drawn_) glDeleteFramebuffers(1, &resolved_);
    glDeleteFramebuffers(1, &drawn_);
    glDeleteRenderbuffers(3, renderbuffers_);
}

void RenderTarget::bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
    glViewport(0, 0, static_cast<GLsizei>(drawn_width_), static_cast<GLsizei>(drawn_height_));
}

void RenderTarget::resolve() const {
    if (resolved_ != drawn_) {
        const bool enlarged = drawn_width_ != width_ || drawn_height_ != height_;
        glBindFramebuffer(GL_READ_FRAMEBUFFER, drawn_);
        glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
        glBlitFramebuffer(0, 0, static_cast<GLint>(drawn_width_), static_cast<GLint>(drawn_height_), 0, 0,
                          static_cast<GLint>(width_), static_cast<GLint>(height_), GL_COLOR_BUFFER_BIT,
                          enlarged ? GL_LINEAR : GL_NEAREST);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, resolved_);
    glViewport(0, 0, static_cast<GLsizei>(width_), static_cast<GLsizei>(height_));
}

void RenderTarget::copy_to_window(uint32_t window_width, uint32_t window_height) const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, static_cast<GLint>(width_), static_cast<GLint>(height_), 0, 0,
                      static_cast<GLint>(window_width), static_cast<GLint>(window_height),
                      GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void RenderTarget::finish() { glFinish(); }

Picture RenderTarget::read() const {
    Picture picture{width_, height_, std::vector<uint8_t>(size_t{width_} * height_ * 3)};
    glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, static_cast<GLsizei>(width_), static_cast<GLsizei>(height_), GL_RGB, GL_UNSIGNED_BYTE,
                 picture.rgb.data());
    const size_t row = size_t{width_} * 3;
    for (size_t top = 0, bottom = height_ - 1; top < bottom; ++top, --bottom)
        std::swap_ranges(picture.rgb.begin() + static_cast<ptrdiff_t>(top * row),
                         picture.rgb.begin() + static_cast<ptrdiff_t>((top + 1) * row),
                         picture.rgb.begin() + static_cast<ptrdiff_t>(bottom * row));
    return picture;
}

}  // namespace trochoid
