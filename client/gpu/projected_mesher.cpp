#include "client/gpu/projected_mesher.hpp"

#include <algorithm>
#include <array>
#include <glm/vec4.hpp>
#include <vector>

#include "client/gpu/gl_health.hpp"

namespace trochoid {

namespace {

/// So narrow that a row's vertices are still in a GPU's cache when the next row wants them.
constexpr uint32_t block_columns = 16;
/// Vertices that 16 bits can name.
constexpr uint32_t most_vertices = 65'536;

/// Columns of quads that one draw takes: about as many as rows, so that few vertices belong to two draws.
constexpr uint32_t draw_columns = 48;

/// Two triangles for each quad of a piece of a grid whose rows have `stride` vertices; in blocks of columns, each from the near
/// row to the far one.
void append_indices(std::vector<uint16_t>& indices, uint32_t rows, uint32_t columns, uint32_t stride) {
    for (uint32_t block = 0; block < columns; block += block_columns)
        for (uint32_t row = 0; row < rows; ++row)
            for (uint32_t column = block; column < std::min(block + block_columns, columns); ++column) {
                const uint32_t near = row * stride + column;
                const uint32_t far = near + stride;
                for (const uint32_t i : std::array{near, near + 1, far, near + 1, far + 1, far})
                    indices.push_back(static_cast<uint16_t>(i));
            }
}

/// The most that waves do anywhere near: of the server's patches, or of all boxes where there are none.
WaveBounds greatest_waves(const InterestState& state, const SeaTable& table) {
    WaveBounds greatest;
    for (const auto& [key, patch] : state.patches) {
        const WaveBounds waves = table.bounds_of_list(table.list_of(key));
        greatest = {std::max(greatest.height, waves.height),
                    std::max(greatest.displacement, waves.displacement)};
    }
    return state.patches.empty() ? table.bounds_of_list(0) : greatest;
}

}  // namespace

ProjectedMesher::ProjectedMesher(MesherUse use)
    : program_(stages_of(use, {"projected.vert"}), options_of(use)),
      axes_uniform_(program_.uniform("projected_axes")),
      columns_uniform_(program_.uniform("projected_columns")) {
    program_.use();
    glUniform1i(program_.uniform("projected_rows"), first_own_unit);
    const std::array<glm::vec4, 1> nothing{};
    rows_.fill(GL_TEXTURE_BUFFER, std::span<const glm::vec4>(nothing), GL_STREAM_DRAW);
    // The texture keeps reading the buffer, whatever store that gets later.
    rows_texture_.bind(GL_TEXTURE_BUFFER, first_own_unit);
    glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, rows_.name());
}

void ProjectedMesher::shape_pieces(const Shape& shape) {
    if (shape == shape_) return;
    shape_ = shape;
    const uint32_t stride = shape.columns + 1;
    piece_columns_ = std::min(draw_columns, shape.columns);
    const uint32_t wanted = std::max(1U, shape.triangles_per_draw / (2 * piece_columns_));
    piece_rows_ = std::min({wanted, most_vertices / stride - 1, shape.rows});
    std::vector<uint16_t> indices;
    for (size_t piece = 0; piece < pieces_.size(); ++piece) {
        const size_t first = indices.size();
        append_indices(indices, piece < 2 ? piece_rows_ : shape.rows % piece_rows_,
                       piece % 2 == 0 ? piece_columns_ : shape.columns % piece_columns_, stride);
        pieces_[piece] = {first, static_cast<GLsizei>(indices.size() - first)};
    }
    layout_.bind();
    indices_.fill(GL_ELEMENT_ARRAY_BUFFER, std::span<const uint16_t>(indices), GL_STATIC_DRAW);
}

MeshCounts ProjectedMesher::prepare(const MesherInput& input) {
    view_ = projected_view(input.culling);
    const ProjectedGrid grid = make_projected_grid(
        view_, greatest_waves(input.state, input.table),
        projected_shape(input.options, view_, input.eye.filter.angle_per_vertex), input.options.attention);
    visible_ = !grid.rows.empty();
    if (!visible_) return {};
    shape_pieces(
        {static_cast<uint32_t>(grid.rows.size() - 1), grid.columns, input.options.triangles_per_draw});
    std::vector<glm::vec4> texels;
    texels.reserve(grid.rows.size());
    for (const ProjectedRow& row : grid.rows)
        texels.emplace_back(row.forward, row.half_width, row.along, row.widening);
    rows_.fill(GL_TEXTURE_BUFFER, std::span<const glm::vec4>(texels), GL_STREAM_DRAW);
    return {0, 2 * shape_.rows * shape_.columns,
            ((shape_.rows + piece_rows_ - 1) / piece_rows_) *
                ((shape_.columns + piece_columns_ - 1) / piece_columns_)};
}

void ProjectedMesher::bind() {
    layout_.bind();
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.name());
    rows_texture_.bind(GL_TEXTURE_BUFFER, first_own_unit);
    program_.use();
}

void ProjectedMesher::draw() {
    if (!visible_) return;
    glUniform4f(axes_uniform_, view_.right.x, view_.right.y, view_.forward.x, view_.forward.y);
    glUniform1i(columns_uniform_, static_cast<GLint>(shape_.columns));
    for (uint32_t row = 0; row < shape_.rows; row += piece_rows_) {
        for (uint32_t column = 0; column < shape_.columns; column += piece_columns_) {
            const size_t last_rows = row + piece_rows_ > shape_.rows ? 2 : 0;
            const Piece& piece = pieces_[last_rows + (column + piece_columns_ > shape_.columns ? 1 : 0)];
            glDrawElementsBaseVertex(GL_TRIANGLES, piece.count, GL_UNSIGNED_SHORT,
                                     buffer_offset(piece.first * sizeof(uint16_t)),
                                     static_cast<GLint>(row * (shape_.columns + 1) + column));
        }
        begin_drawing();
    }
}

}  // namespace trochoid
