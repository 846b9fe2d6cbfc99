#pragma once
#include <epoxy/gl.h>

#include <cstddef>
#include <span>
#include <utility>

namespace trochoid {

/// A place in the vertex buffer at hand, which OpenGL wants as a pointer.
inline const void* buffer_offset(size_t bytes) {
    return reinterpret_cast<const void*>(bytes);  // NOLINT(performance-no-int-to-ptr)
}

/// Owners of OpenGL names; the context must be current when they come and go. Neither copied nor moved.
class GlBuffer {
public:
    GlBuffer() { glGenBuffers(1, &name_); }
    GlBuffer(const GlBuffer&) = delete;
    GlBuffer& operator=(const GlBuffer&) = delete;
    ~GlBuffer() { glDeleteBuffers(1, &name_); }
    GLuint name() const { return name_; }

    /// Replaces the contents; the old store is orphaned, so nothing waits for the GPU.
    template <class T>
    void fill(GLenum target, std::span<const T> values, GLenum usage) {
        glBindBuffer(target, name_);
        glBufferData(target, static_cast<GLsizeiptr>(values.size_bytes()), values.data(), usage);
    }

private:
    GLuint name_ = 0;
};

class GlVertexArray {
public:
    GlVertexArray() { glGenVertexArrays(1, &name_); }
    GlVertexArray(const GlVertexArray&) = delete;
    GlVertexArray& operator=(const GlVertexArray&) = delete;
    ~GlVertexArray() { glDeleteVertexArrays(1, &name_); }
    GLuint name() const { return name_; }
    void bind() const { glBindVertexArray(name_); }

private:
    GLuint name_ = 0;
};

class GlTexture {
public:
    GlTexture() { glGenTextures(1, &name_); }
    GlTexture(const GlTexture&) = delete;
    GlTexture& operator=(const GlTexture&) = delete;
    ~GlTexture() { glDeleteTextures(1, &name_); }
    GLuint name() const { return name_; }
    void bind(GLenum target, GLint unit) const {
        glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
        glBindTexture(target, name_);
    }

private:
    GLuint name_ = 0;
};

/// A buffer that shaders read as texels.
class GlTexelBuffer {
public:
    explicit GlTexelBuffer(GLenum format) : format_(format) {}

    template <class T>
    void fill(std::span<const T> texels, GLenum usage) {
        // An empty store has no size to fetch from: keep one texel of zeros.
        static const T nothing{};
        buffer_.fill(GL_TEXTURE_BUFFER, texels.empty() ? std::span<const T>(&nothing, 1) : texels, usage);
        texture_.bind(GL_TEXTURE_BUFFER, 0);
        glTexBuffer(GL_TEXTURE_BUFFER, format_, buffer_.name());
    }
    void bind(GLint unit) const { texture_.bind(GL_TEXTURE_BUFFER, unit); }

private:
    GLenum format_;
    GlBuffer buffer_;
    GlTexture texture_;
};

}  // namespace trochoid
