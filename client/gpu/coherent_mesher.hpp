#pragma once
#include "client/gpu/coherent_mesh.hpp"
#include "client/gpu/mesher.hpp"

namespace trochoid {

/// Paper D's mesher (rows D1 to D4): edge-based tessellation whose triangles stay on the GPU from frame to frame.
class CoherentMesher : public Mesher {
public:
    explicit CoherentMesher(MesherUse use);
    MeshCounts prepare(const MesherInput& input) override;
    void bind() override;
    void draw() override;

    /// What the last prepare() took.
    const CoherentWork& work() const { return work_; }
    CoherentMesh& mesh() { return mesh_; }

private:
    CoherentMesh mesh_;
    ShaderProgram program_;
    GlVertexArray nothing_;
    CoherentWork work_;
    LatticePoint anchor_;
    uint32_t triangles_per_draw_ = 1;
};

}  // namespace trochoid
