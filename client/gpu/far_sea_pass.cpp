#include "client/gpu/far_sea_pass.hpp"

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <vector>

namespace trochoid {

FarSeaPass::FarSeaPass() {
    layout_.bind();
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(glm::vec2), nullptr);
}

void FarSeaPass::draw(float radius_m) {
    constexpr uint32_t sectors = 64;
    constexpr uint32_t rings = 30;
    layout_.bind();
    if (radius_m != radius_m_) {
        radius_m_ = radius_m;
        std::vector<glm::vec2> vertices;
        std::vector<uint16_t> indices;
        for (uint32_t ring = 0; ring <= rings; ++ring)
            for (uint32_t sector = 0; sector <= sectors; ++sector) {
                // 0, then from 30 m outwards by equal ratios.
                const double share = static_cast<double>(ring) / rings;
                const double r =
                    ring == 0 ? 0.0 : 30.0 * std::pow(static_cast<double>(radius_m) / 30.0, share);
                vertices.emplace_back(static_cast<float>(r),
                                      static_cast<float>(6.283185307179586 * sector / sectors));
            }
        for (uint32_t ring = 0; ring < rings; ++ring)
            for (uint32_t sector = 0; sector < sectors; ++sector) {
                const auto a = static_cast<uint16_t>(ring * (sectors + 1) + sector);
                const auto b = static_cast<uint16_t>(a + sectors + 1);
                for (const uint16_t i : {a, b, static_cast<uint16_t>(a + 1), static_cast<uint16_t>(a + 1), b,
                                         static_cast<uint16_t>(b + 1)})
                    indices.push_back(i);
            }
        vertices_.fill(GL_ARRAY_BUFFER, std::span<const glm::vec2>(vertices), GL_STATIC_DRAW);
        indices_.fill(GL_ELEMENT_ARRAY_BUFFER, std::span<const uint16_t>(indices), GL_STATIC_DRAW);
        index_count_ = static_cast<GLsizei>(indices.size());
    }
    program_.use();
    glEnable(GL_STENCIL_TEST);
    glStencilFunc(GL_NOTEQUAL, 1, 0xff);
    glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.name());
    glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_SHORT, nullptr);
    glDisable(GL_STENCIL_TEST);
}

}  // namespace trochoid
