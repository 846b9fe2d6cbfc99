#include "client/gpu/coherent_land.hpp"

#include <algorithm>

namespace trochoid {

namespace {

/// Deeper ground is not seen through the water (hidden_depth of coherent_land.vert).
constexpr float hidden_depth_m = 12.0F;

/// The sides of the bed map in place of the view's: what lies outside is coarse and left out.
std::array<glm::vec4, 4> sides_of(const BedMap& bed, LatticePoint eye) {
    const auto west = static_cast<float>(to_metres(eye.x - bed.origin_x));
    const auto north = static_cast<float>(to_metres(eye.z - bed.origin_z));
    const auto width = static_cast<float>(bed.spacing_m * (bed.columns - 1));
    const auto height = static_cast<float>(bed.spacing_m * (bed.rows - 1));
    return {glm::vec4(1, 0, 0, west), glm::vec4(-1, 0, 0, width - west), glm::vec4(0, 0, 1, north),
            glm::vec4(0, 0, -1, height - north)};
}

}  // namespace

CoherentLand::CoherentLand() : cell_uniform_(program_.uniform("cell")) {}

void CoherentLand::prepare(const FrameUniforms& frame, GLuint frame_buffer, LatticePoint anchor,
                           const MeshEye& eye, const FrustumPlanes& planes, const BedMap& bed,
                           uint32_t most_triangles) {
    work_ = {};
    if (bed.columns < 2 || bed.rows < 2) return;
    anchor_ = anchor;
    cell_m_ = static_cast<float>(bed.spacing_m);
    MeshEye own = eye;
    own.filter.finest_spacing = std::max(own.filter.finest_spacing, cell_m_);
    if (own.refinement != Refinement::frustum) {
        own.sides = sides_of(bed, {anchor.x + eye.cell.x, anchor.z + eye.cell.y});
        if (own.refinement == Refinement::distance) own.refinement = Refinement::frustum;
    }
    FrameUniforms u = frame;
    u.mesh_filter.x = own.filter.finest_spacing;
    u.choice.z = static_cast<int>(own.refinement);
    u.mesh_sides = own.sides;
    uniforms_.fill(GL_UNIFORM_BUFFER, std::span<const FrameUniforms>(&u, 1), GL_STREAM_DRAW);
    glBindBufferBase(GL_UNIFORM_BUFFER, frame_binding, uniforms_.name());
    work_ = mesh_.update(anchor, own, most_triangles);
    const float highest = *std::max_element(bed.heights.begin(), bed.heights.end());
    mesh_.list_visible(anchor, planes, std::max(highest, hidden_depth_m));
    glBindBufferBase(GL_UNIFORM_BUFFER, frame_binding, frame_buffer);
}

void CoherentLand::draw(GLuint frame_buffer, bool wireframe) {
    if (work_.triangles == 0) return;
    nothing_.bind();
    program_.use();
    mesh_.bind_triangles(program_, anchor_);
    glUniform1f(cell_uniform_, cell_m_);
    glBindBufferBase(GL_UNIFORM_BUFFER, frame_binding, uniforms_.name());
    if (wireframe) glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(mesh_.visible()) * 3);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glBindBufferBase(GL_UNIFORM_BUFFER, frame_binding, frame_buffer);
}

}  // namespace trochoid
