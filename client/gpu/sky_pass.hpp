#pragma once
#include <optional>

#include "client/gpu/frame_uniforms.hpp"
#include "client/gpu/gl_objects.hpp"
#include "client/gpu/shader_program.hpp"
#include "client/scene/sky_model.hpp"

namespace trochoid {

/// The sky: its light, its picture behind everything, and a small cube map of it with clouds that the sea reflects.
class SkyPass {
public:
    explicit SkyPass(DepthRange range);
    SkyPass(const SkyPass&) = delete;
    SkyPass& operator=(const SkyPass&) = delete;
    ~SkyPass();

    /// Light of an hour; makes the clear sky's cube map anew when the hour has moved on by more than half a minute.
    const SkyLight& light_at(double hour);
    /// Draws the reflected cube map where clouds or weather have changed, once in two seconds of sea time at most, and binds it.
    /// The Frame block must be bound; the framebuffer and viewport are changed.
    void prepare(SeaTime now, const FrameUniforms& frame);
    /// Of the reflected cube map's levels.
    void set_smaller_filter(GLenum filter);
    /// The picture's sky; depth function and framebuffer are the caller's.
    void draw();

    static constexpr uint32_t cube_side = 64;

private:
    void upload(const SkyModel& model);

    ShaderProgram picture_;
    ShaderProgram cube_;
    GLint face_uniform_;
    GlTexture clear_;
    GlTexture reflected_;
    GlVertexArray nothing_;
    GLuint framebuffer_ = 0;
    SkyLight light_;
    double made_for_hour_ = -1;
    std::optional<int64_t> drawn_for_;  // two seconds of sea time
    float drawn_overcast_ = -1;
};

}  // namespace trochoid
