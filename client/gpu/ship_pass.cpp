#include "client/gpu/ship_pass.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat3x3.hpp>

namespace trochoid {

namespace {

/// Columns: towards the bow, up along the masts, to starboard; orthonormal.
glm::mat3 axes_of(const FloatingShip& floating) {
    const glm::dvec2 h = floating.ship.heading;
    const glm::dvec3 bow = glm::normalize(glm::dvec3(h.x, floating.pose.pitch, h.y));
    const glm::dvec3 starboard(-h.y, floating.pose.roll, h.x);
    const glm::dvec3 up = glm::normalize(glm::cross(starboard, bow));
    return glm::mat3(glm::vec3(bow), glm::vec3(up), glm::vec3(glm::cross(bow, up)));
}

/// How high the bow throws the water up, m: half the head of its speed, held where a hull would begin to plane.
float wash_of(const Ship& ship) {
    return static_cast<float>(std::min(ship.speed * ship.speed / (4.0 * 9.81), 0.025 * ship.length));
}

}  // namespace

ShipPass::ShipPass()
    : place_uniform_(program_.uniform("ship_place")),
      axes_uniform_(program_.uniform("ship_axes")),
      size_uniform_(program_.uniform("ship_size")),
      wash_uniform_(program_.uniform("ship_wash")) {
    fill(freighter_, freighter_hull());
    fill(launch_, launch_hull());
}

void ShipPass::fill(Hull& hull, std::span<const HullVertex> vertices) {
    hull.layout.bind();
    hull.vertices.fill(GL_ARRAY_BUFFER, vertices, GL_STATIC_DRAW);
    hull.count = static_cast<GLsizei>(vertices.size());
    const auto floats = [](GLuint attribute, GLint count, size_t offset) {
        glEnableVertexAttribArray(attribute);
        glVertexAttribPointer(attribute, count, GL_FLOAT, GL_FALSE, sizeof(HullVertex),
                              buffer_offset(offset));
    };
    floats(0, 3, offsetof(HullVertex, place));
    floats(1, 3, offsetof(HullVertex, normal));
    floats(2, 4, offsetof(HullVertex, colour));
}

void ShipPass::draw(std::span<const FloatingShip> ships, const CameraFrame& frame, bool wireframe) {
    if (ships.empty()) return;
    program_.use();
    if (wireframe) glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    for (const FloatingShip& floating : ships) {
        const Ship& ship = floating.ship;
        const int64_t x = ship.place.x - frame.anchor.x;
        const int64_t z = ship.place.z - frame.anchor.z;
        if (std::max(std::abs(x), std::abs(z)) > anchor_reach) continue;
        glUniform2i(place_uniform_, static_cast<GLint>(x), static_cast<GLint>(z));
        const glm::mat3 axes = axes_of(floating);
        glUniformMatrix3fv(axes_uniform_, 1, GL_FALSE, glm::value_ptr(axes));
        glUniform3f(size_uniform_, static_cast<float>(ship.length), static_cast<float>(ship.beam),
                    static_cast<float>(floating.pose.heave));
        glUniform1f(wash_uniform_, wash_of(ship));
        const Hull& hull = ship.length < shortest_freighter_m ? launch_ : freighter_;
        hull.layout.bind();
        glDrawArrays(GL_TRIANGLES, 0, hull.count);
    }
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

}  // namespace trochoid
