#pragma once
#include "client/gpu/coherent_mesh.hpp"
#include "client/gpu/frame_uniforms.hpp"

namespace trochoid {

/// Land by paper D's mesher (row D9): a second coherent mesh whose corners take the height of the bed map, shaded as the tiles of
/// LandPass are.
class CoherentLand {
public:
    CoherentLand();

    /// Makes the mesh for an eye as the sea's, no finer than the bed map and coarse outside of it; of it, what may lie inside the
    /// eye's `planes` is drawn. The sea's buffers are bound;
    /// `frame` is the block that is drawn with, which the binding point holds again afterwards.
    void prepare(const FrameUniforms& frame, GLuint frame_buffer, LatticePoint anchor, const MeshEye& eye,
                 const FrustumPlanes& planes, const BedMap& bed, uint32_t most_triangles);
    /// Draws what prepare() made; `frame_buffer` as there.
    void draw(GLuint frame_buffer, bool wireframe);

    const CoherentWork& work() const { return work_; }

private:
    CoherentMesh mesh_;
    ShaderProgram program_{"coherent_land.vert", "land.frag"};
    GLint cell_uniform_ = -1;
    GlVertexArray nothing_;
    GlBuffer uniforms_;  // the Frame block with the land's own criterion
    CoherentWork work_;
    LatticePoint anchor_;
    float cell_m_ = 1;
};

}  // namespace trochoid
