#include "client/gpu/spray_pass.hpp"

namespace trochoid {

void SprayPass::draw(const FoamPass& foam, float wind_m_s, uint32_t picture_height) {
    constexpr float least_wind_m_s = 12.0F;
    const uint32_t map_side = foam.side();
    if (map_side == 0 || wind_m_s < least_wind_m_s) return;
    glEnable(GL_PROGRAM_POINT_SIZE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glDepthMask(GL_FALSE);
    program_.use();
    foam.bind();
    glUniform2f(program_.uniform("spray"), static_cast<float>(map_side), static_cast<float>(picture_height));
    nothing_.bind();
    glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(map_side * map_side) * droplets_per_texel);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_PROGRAM_POINT_SIZE);
}

}  // namespace trochoid
