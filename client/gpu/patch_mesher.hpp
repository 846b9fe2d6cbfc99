#pragma once
#include "client/gpu/gl_objects.hpp"
#include "client/gpu/mesher.hpp"
#include "client/scene/sea_mesh.hpp"

namespace trochoid {

/// The server's patches, cut into squares that the tessellation units divide (row D7), drawn in batches, nearest first.
class PatchMesher : public Mesher {
public:
    explicit PatchMesher(MesherUse use);
    MeshCounts prepare(const MesherInput& input) override;
    void bind() override;
    void draw() override;

private:
    ShaderProgram program_;
    GlVertexArray layout_;
    GlBuffer quads_;
    SeaMesh mesh_;
};

}  // namespace trochoid
