#include "client/gpu/patch_mesher.hpp"

#include "client/gpu/gl_health.hpp"

namespace trochoid {

namespace {

/// Each beginning costs a renderer on the processor a walk over the picture's tiles.
constexpr uint32_t triangles_at_once = 10'000;

}  // namespace

PatchMesher::PatchMesher(MesherUse use)
    : program_(stages_of(use, {"sea.vert", "sea.tesc", "sea.tese"}), options_of(use)) {
    layout_.bind();
    glBindBuffer(GL_ARRAY_BUFFER, quads_.name());
    glEnableVertexAttribArray(0);
    glVertexAttribIPointer(0, 4, GL_INT, sizeof(SeaQuad), nullptr);
}

MeshCounts PatchMesher::prepare(const MesherInput& input) {
    mesh_ = build_sea_mesh(input.state, input.table, input.culling, input.planes,
                           {input.eye, input.options.triangles_per_draw});
    quads_.fill(GL_ARRAY_BUFFER, std::span<const SeaQuad>(mesh_.quads), GL_STREAM_DRAW);
    return {static_cast<uint32_t>(mesh_.drawn.size()), mesh_.triangles,
            static_cast<uint32_t>(mesh_.batches.size())};
}

void PatchMesher::bind() {
    layout_.bind();
    program_.use();
}

void PatchMesher::draw() {
    glPatchParameteri(GL_PATCH_VERTICES, 1);
    uint32_t told = 0;
    for (const SeaBatch& batch : mesh_.batches) {
        glDrawArrays(GL_PATCHES, static_cast<GLint>(batch.first), static_cast<GLsizei>(batch.count));
        told += batch.triangles;
        if (told < triangles_at_once) continue;
        begin_drawing();
        told = 0;
    }
}

}  // namespace trochoid
