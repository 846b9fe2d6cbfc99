#pragma once
#include <glm/vec2.hpp>
#include <vector>

#include "client/gpu/gl_objects.hpp"
#include "client/gpu/mesher.hpp"

namespace trochoid {

/// Paper A's water grid: a square of equal cells, centred below the camera on its own lattice, drawn tile by tile so that what
/// is out of view costs nothing (row A10). Waves fade towards its edges.
class UniformMesher : public Mesher {
public:
    /// Cells along a side of a tile; the grid's side is rounded up to whole tiles.
    static constexpr int tile_cells = grid_cells_step;

    explicit UniformMesher(MesherUse use);
    MeshCounts prepare(const MesherInput& input) override;
    void bind() override;
    void draw() override;

private:
    ShaderProgram program_;
    GLint shape_uniform_;
    GLint edge_uniform_;
    GlVertexArray layout_;
    GlBuffer indices_;
    GlBuffer corners_;
    GLsizei index_count_ = 0;
    std::vector<glm::ivec2>
        tiles_;          // north-west corners relative to the anchor, lattice units, nearest first
    int step_log2_ = 0;  // of a cell, lattice units
    glm::vec2 edge_{0};  // as the shader takes it
    size_t tiles_a_draw_ = 1;
};

}  // namespace trochoid
