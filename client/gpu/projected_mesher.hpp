#pragma once
#include <array>

#include "client/gpu/gl_objects.hpp"
#include "client/gpu/mesher.hpp"
#include "client/scene/projected_grid.hpp"

namespace trochoid {

/// Paper B's grid on the screen, cast on the sea (rows B3 and B4), drawn piece by piece, nearest first.
class ProjectedMesher : public Mesher {
public:
    explicit ProjectedMesher(MesherUse use);
    MeshCounts prepare(const MesherInput& input) override;
    void bind() override;
    void draw() override;

private:
    struct Shape {
        uint32_t rows = 0;  ///< of quads
        uint32_t columns = 0;
        uint32_t triangles_per_draw = 0;
        bool operator==(const Shape&) const = default;
    };
    struct Piece {
        size_t first = 0;  // index
        GLsizei count = 0;
    };
    void shape_pieces(const Shape& shape);

    ShaderProgram program_;
    GLint axes_uniform_;
    GLint columns_uniform_;
    GlVertexArray layout_;
    GlBuffer indices_;
    GlBuffer rows_;
    GlTexture rows_texture_;
    ProjectedView view_;
    Shape shape_;
    uint32_t piece_rows_ = 1;  // quads in one draw
    uint32_t piece_columns_ = 1;
    std::array<Piece, 4> pieces_;  // whole; narrower at the right; shorter at the far end; both
    bool visible_ = false;
};

}  // namespace trochoid
