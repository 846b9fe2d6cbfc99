#include "client/gpu/sky_pass.hpp"

#include <array>
#include <cmath>

namespace trochoid {

namespace {

constexpr auto cube_levels = 7;  // of 64 texels

/// Depth of infinity as the vertex shader writes it.
ShaderProgramOptions picture_options(DepthRange range) {
    return {{range == DepthRange::reversed_zero_to_one ? "SKY_DEPTH 0.0" : "SKY_DEPTH 1.0"}, {}};
}

GLenum face_target(uint32_t face) { return GL_TEXTURE_CUBE_MAP_POSITIVE_X + face; }

void set_filters(GLenum smaller) {
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(smaller));
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    for (const auto axis : std::array<GLenum, 3>{GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        glTexParameteri(GL_TEXTURE_CUBE_MAP, axis, GL_CLAMP_TO_EDGE);
}

}  // namespace

SkyPass::SkyPass(DepthRange range)
    : picture_({"sky.vert", "sky.frag"}, picture_options(range)),
      cube_({"sky_cube.vert", "sky_cube.frag"}),
      face_uniform_(cube_.uniform("face")) {
    glGenFramebuffers(1, &framebuffer_);
    glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    reflected_.bind(GL_TEXTURE_CUBE_MAP, sky_unit);
    for (uint32_t face = 0; face < 6; ++face)
        for (int level = 0; level < cube_levels; ++level) {
            const auto side = static_cast<GLsizei>(cube_side >> static_cast<uint32_t>(level));
            glTexImage2D(face_target(face), level, GL_RGBA16F, side, side, 0, GL_RGBA, GL_FLOAT, nullptr);
        }
    set_filters(GL_LINEAR_MIPMAP_LINEAR);
}

SkyPass::~SkyPass() { glDeleteFramebuffers(1, &framebuffer_); }

void SkyPass::upload(const SkyModel& model) {
    clear_.bind(GL_TEXTURE_CUBE_MAP, clear_sky_unit);
    const auto faces = model.cube(cube_side);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    for (uint32_t face = 0; face < 6; ++face)
        glTexImage2D(face_target(face), 0, GL_RGB16F, cube_side, cube_side, 0, GL_RGB, GL_FLOAT,
                     faces[face].data());
    set_filters(GL_LINEAR);
}

const SkyLight& SkyPass::light_at(double hour) {
    if (std::abs(hour - made_for_hour_) > 0.008) {
        const SkyModel model(hour);
        light_ = model.light();
        upload(model);
        made_for_hour_ = hour;
        drawn_for_.reset();
    }
    return light_;
}

void SkyPass::prepare(SeaTime now, const FrameUniforms& frame) {
    const int64_t period = now.us / 2'000'000;
    const bool weather = std::abs(frame.overcast.w - drawn_overcast_) > 0.01F;
    clear_.bind(GL_TEXTURE_CUBE_MAP, clear_sky_unit);
    if (period != drawn_for_ || weather) {
        drawn_for_ = period;
        drawn_overcast_ = frame.overcast.w;
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
        glViewport(0, 0, cube_side, cube_side);
        glDisable(GL_DEPTH_TEST);
        cube_.use();
        nothing_.bind();
        for (GLint face = 0; face < 6; ++face) {
            glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0,
                                   face_target(static_cast<uint32_t>(face)), reflected_.name(), 0);
            glUniform1i(face_uniform_, face);
            glDrawArrays(GL_TRIANGLES, 0, 3);
        }
        reflected_.bind(GL_TEXTURE_CUBE_MAP, sky_unit);
        glGenerateMipmap(GL_TEXTURE_CUBE_MAP);
    }
    reflected_.bind(GL_TEXTURE_CUBE_MAP, sky_unit);
}

void SkyPass::set_smaller_filter(GLenum filter) {
    reflected_.bind(GL_TEXTURE_CUBE_MAP, sky_unit);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(filter));
}

void SkyPass::draw() {
    picture_.use();
    nothing_.bind();
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace trochoid
