#include "client/gpu/coherent_mesher.hpp"

namespace trochoid {

CoherentMesher::CoherentMesher(MesherUse use)
    : program_(stages_of(use, {"coherent.vert"}), options_of(use)) {}

MeshCounts CoherentMesher::prepare(const MesherInput& input) {
    anchor_ = input.culling.anchor;
    work_ = mesh_.update(anchor_, input.eye, input.options.most_triangles);
    return {0, work_.triangles, 1};
}

void CoherentMesher::bind() {
    nothing_.bind();
    program_.use();
    mesh_.bind_triangles(program_, anchor_);
}

void CoherentMesher::draw() { glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(work_.triangles) * 3); }

}  // namespace trochoid
