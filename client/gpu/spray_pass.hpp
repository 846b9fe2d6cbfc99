#pragma once
#include "client/gpu/foam_pass.hpp"
#include "client/gpu/gl_objects.hpp"
#include "client/gpu/shader_program.hpp"

namespace trochoid {

/// Spray torn off breaking crests (row A11): points that are born where the foam map says that a crest has broken and fly as
/// their age tells, so they have no state of their own.
class SprayPass {
public:
    /// Only in gale and storm is there any. Depth test and framebuffer are the caller's.
    void draw(const FoamPass& foam, float wind_m_s, uint32_t picture_height);

    static constexpr int droplets_per_texel = 4;

private:
    ShaderProgram program_{"spray.vert", "spray.frag"};
    GlVertexArray nothing_;
};

}  // namespace trochoid
