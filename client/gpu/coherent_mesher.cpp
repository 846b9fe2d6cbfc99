#include "client/gpu/coherent_mesher.hpp"

#include <algorithm>

#include "client/gpu/gl_health.hpp"

namespace trochoid {

CoherentMesher::CoherentMesher(MesherUse use)
    : program_(stages_of(use, {"coherent.vert"}), options_of(use)) {}

MeshCounts CoherentMesher::prepare(const MesherInput& input) {
    anchor_ = input.culling.anchor;
    work_ = mesh_.update(anchor_, input.eye, input.options.most_triangles);
    // The mesh is what the eye wants all around; a corner is displaced only where one of its triangles may be in view.
    const WaveBounds waves = input.table.bounds_of_list(0);
    mesh_.list_visible(anchor_, input.planes, waves.height + waves.displacement);
    triangles_per_draw_ = std::max(input.options.triangles_per_draw, 1U);
    return {0, work_.triangles, (work_.triangles + triangles_per_draw_ - 1) / triangles_per_draw_};
}

void CoherentMesher::bind() {
    nothing_.bind();
    program_.use();
    mesh_.bind_triangles(program_, anchor_);
    mesh_.visible();  // waits here, when other passes keep the GPU busy, rather than in prepare()
}

void CoherentMesher::draw() {
    const uint32_t all = mesh_.visible();
    for (uint32_t first = 0; first < all; first += triangles_per_draw_) {
        const uint32_t count = std::min(triangles_per_draw_, all - first);
        glDrawArrays(GL_TRIANGLES, static_cast<GLint>(first * 3), static_cast<GLsizei>(count * 3));
        if (count == triangles_per_draw_) begin_drawing();
    }
}

}  // namespace trochoid
