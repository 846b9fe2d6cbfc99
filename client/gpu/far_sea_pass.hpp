#pragma once
#include "client/gpu/gl_objects.hpp"
#include "client/gpu/shader_program.hpp"

namespace trochoid {

/// The sea beyond the patches, down to the horizon: a disc around the camera where the stencil holds no patch.
class FarSeaPass {
public:
    FarSeaPass();
    /// Reaches out to `radius_m`.
    void draw(float radius_m);

private:
    ShaderProgram program_{"far_sea.vert", "far_sea.frag"};
    GlVertexArray layout_;
    GlBuffer vertices_;
    GlBuffer indices_;
    float radius_m_ = 0;
    GLsizei index_count_ = 0;
};

}  // namespace trochoid
