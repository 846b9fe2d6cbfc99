#include "client/gpu/coherent_mesher.hpp"

namespace trochoid {

CoherentMesher::CoherentMesher(MesherUse use)
    : everything_(use == MesherUse::probe), program_(stages_of(use, {"coherent.vert"}), options_of(use)) {}

MeshCounts CoherentMesher::prepare(const MesherInput& input) {
    anchor_ = input.culling.anchor;
    work_ = mesh_.update(anchor_, input.eye, input.options.most_triangles);
    mesh_.list_visible(anchor_, {0.0F, everything_});
    return {0, work_.triangles, 1};
}

void CoherentMesher::bind() {
    nothing_.bind();
    program_.use();
    mesh_.bind_triangles(program_, anchor_);
    mesh_.visible();  // waits here, when other passes keep the GPU busy, rather than in prepare()
}

void CoherentMesher::draw() { glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(mesh_.visible()) * 3); }

}  // namespace trochoid
