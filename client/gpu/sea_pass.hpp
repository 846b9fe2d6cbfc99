#pragma once
#include "client/gpu/gl_objects.hpp"
#include "client/gpu/shader_program.hpp"
#include "client/scene/bed_map.hpp"
#include "client/scene/ripple_map.hpp"
#include "client/scene/sea_mesh.hpp"
#include "client/scene/sea_table.hpp"

namespace trochoid {

/// The tables of the sea on the GPU, shared by all passes that evaluate it.
class SeaBuffers {
public:
    SeaBuffers();
    /// Every frame: rows with this moment's phases and envelopes.
    void set_records(const std::vector<RecordTexel>& records);
    /// When the state changes.
    void set_lists(const std::vector<ListTexel>& lists);
    void set_land(const LandTable& land);
    void set_bed(const BedMap& bed);
    void bind() const;

private:
    GlTexelBuffer records_{GL_RGBA32I};
    GlTexelBuffer lists_{GL_RG32I};
    GlTexelBuffer slots_{GL_R32I};
    GlTexelBuffer nodes_{GL_RG32I};
    GlTexelBuffer wakes_{GL_RGBA32I};
    GlTexture ripples_;
    GlTexture bed_;
};

/// The near sea: tessellated patches, drawn in batches. Writes 1 into the stencil wherever a patch lies.
class SeaPass {
public:
    SeaPass();
    void draw(const SeaMesh& mesh, bool wireframe);

private:
    ShaderProgram program_{"sea.vert", "sea.tesc", "sea.tese", "sea.frag"};
    GlVertexArray quads_layout_;
    GlBuffer quads_;
};

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
