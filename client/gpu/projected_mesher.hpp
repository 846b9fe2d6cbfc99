#pragma once
#include "client/gpu/gl_objects.hpp"
#include "client/gpu/mesher.hpp"
#include "client/scene/projected_grid.hpp"

namespace trochoid {

/// Paper B's grid on the screen, cast on the sea (rows B3 and B4), drawn in bands of rows, nearest first.
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
    void shape_bands(const Shape& shape);

    ShaderProgram program_;
    GLint axes_uniform_;
    GLint columns_uniform_;
    GlVertexArray layout_;
    GlBuffer indices_;  // of one band, then of the last where it has fewer rows
    GlBuffer rows_;
    GlTexture rows_texture_;
    ProjectedView view_;
    Shape shape_;
    uint32_t band_ = 1;  // rows of quads in one draw
    GLsizei band_size_ = 0;
    GLsizei last_size_ = 0;
    bool visible_ = false;
};

}  // namespace trochoid
