#include "client/gpu/far_sea_pass.hpp"

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <vector>

namespace trochoid {

namespace {

// Equal ratios from ring to ring: under a tenth from one to the next, at which a ramp of 2 km is still smooth 20 km off.
constexpr uint32_t sectors = 48;
constexpr uint32_t rings = 88;
constexpr float pi = 3.14159265F;

}  // namespace

glm::vec3 seen_fan(const Camera& camera) {
    const double half_up = camera.vertical_angle / 2;
    const double tangent = std::tan(half_up) * camera.width / camera.height;
    // The lowest line of sight decides how near the fan begins, and how wide it is.
    const double lowest = camera.pitch - half_up;
    const double highest = camera.pitch + half_up;
    constexpr double margin = 0.05;
    if (lowest < -1.35 || highest > 1.5) return {0.0F, 2.0F * pi, 0.0F};
    const double steepest = std::max(std::abs(lowest), std::abs(highest));
    // In the corner of a picture the view's yaw is off by atan(tangent * cos(half_up) / cos(pitch of the row)).
    const double off = std::atan2(tangent * std::cos(half_up), std::cos(steepest)) + margin;
    if (off > 1.5) return {0.0F, 2.0F * pi, 0.0F};
    const double nearest = lowest < -0.01 ? camera.altitude_m / std::tan(-lowest) : camera.altitude_m * 100.0;
    return {static_cast<float>(camera.yaw - off), static_cast<float>(2.0 * off),
            static_cast<float>(std::clamp(nearest * 0.6 * std::cos(off) - 30.0, 0.0, 3'000.0))};
}

FarSeaPass::FarSeaPass() {
    std::vector<uint16_t> indices;
    for (uint32_t ring = 0; ring < rings; ++ring)
        for (uint32_t sector = 0; sector < sectors; ++sector) {
            const auto a = static_cast<uint16_t>(ring * (sectors + 1) + sector);
            const auto b = static_cast<uint16_t>(a + sectors + 1);
            for (const uint16_t i : {a, b, static_cast<uint16_t>(a + 1), static_cast<uint16_t>(a + 1), b,
                                     static_cast<uint16_t>(b + 1)})
                indices.push_back(i);
        }
    layout_.bind();
    indices_.fill(GL_ELEMENT_ARRAY_BUFFER, std::span<const uint16_t>(indices), GL_STATIC_DRAW);
    index_count_ = static_cast<GLsizei>(indices.size());
}

void FarSeaPass::draw(const Camera& camera, float radius_m) {
    const glm::vec3 fan = seen_fan(camera);
    layout_.bind();
    program_.use();
    glUniform4f(program_.uniform("fan"), fan.x, fan.y, fan.z, radius_m);
    glUniform2i(program_.uniform("counts"), static_cast<GLint>(sectors), static_cast<GLint>(rings));
    glEnable(GL_STENCIL_TEST);
    glStencilFunc(GL_NOTEQUAL, 1, 0xff);
    glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_SHORT, nullptr);
    glDisable(GL_STENCIL_TEST);
}

}  // namespace trochoid
