#pragma once
#include <glm/vec2.hpp>
#include <vector>

#include "client/gpu/gl_objects.hpp"
#include "client/gpu/mesher.hpp"

namespace trochoid {

/// Paper A's water grid: a square of equal cells, centred below the camera on its own lattice, drawn tile by tile so that what
/// is out of view costs nothing (row A10).
class UniformMesher : public Mesher {
public:
    explicit UniformMesher(MesherUse use);
    MeshCounts prepare(const MesherInput& input) override;
    void bind() override;
    void draw() override;

private:
    ShaderProgram program_;
    GLint tile_uniform_;
    GlVertexArray layout_;
    GlBuffer indices_;
    GLsizei index_count_ = 0;
    std::vector<glm::ivec2> tiles_;  // north-west corners relative to the anchor, lattice units
    int step_log2_ = 0;              // of a cell, lattice units
};

}  // namespace trochoid
