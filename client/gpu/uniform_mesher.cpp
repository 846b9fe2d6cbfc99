#include "client/gpu/uniform_mesher.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>

#include "client/gpu/gl_health.hpp"

namespace trochoid {

namespace {

constexpr int tile_cells = UniformMesher::tile_cells;
constexpr int most_tiles = 1024 / tile_cells;  // along a side
/// Share of the way from the camera to the grid's edge from which waves fade.
constexpr float fading_from = 0.65F;

std::vector<uint16_t> tile_indices() {
    std::vector<uint16_t> indices;
    for (int row = 0; row < tile_cells; ++row)
        for (int column = 0; column < tile_cells; ++column) {
            const auto a = static_cast<uint16_t>(row * (tile_cells + 1) + column);
            const auto b = static_cast<uint16_t>(a + tile_cells + 1);
            for (const uint16_t i : {a, b, static_cast<uint16_t>(a + 1), static_cast<uint16_t>(a + 1), b,
                                     static_cast<uint16_t>(b + 1)})
                indices.push_back(i);
        }
    return indices;
}

/// The power of two of lattice units nearest to a spacing.
int step_log2_of(float spacing_m) {
    return std::clamp(static_cast<int>(std::lround(std::log2(spacing_m * 1024.0F))), 6, 16);
}

}  // namespace

UniformMesher::UniformMesher(MesherUse use)
    : program_(stages_of(use, {"uniform.vert"}), options_of(use)),
      shape_uniform_(program_.uniform("grid_shape")),
      edge_uniform_(program_.uniform("grid_edge")) {
    layout_.bind();
    const std::vector<uint16_t> indices = tile_indices();
    indices_.fill(GL_ELEMENT_ARRAY_BUFFER, std::span<const uint16_t>(indices), GL_STATIC_DRAW);
    index_count_ = static_cast<GLsizei>(indices.size());
    glEnableVertexAttribArray(0);
    glVertexAttribDivisor(0, 1);
}

MeshCounts UniformMesher::prepare(const MesherInput& input) {
    step_log2_ = step_log2_of(input.options.grid_spacing_m);
    const int side = tile_cells << step_log2_;
    const int tiles_a_side =
        std::clamp((static_cast<int>(input.options.grid_cells) + tile_cells - 1) / tile_cells, 1, most_tiles);
    const WaveBounds waves = input.table.bounds_of_list(0);
    tiles_.clear();
    // On whole cells, so that vertices stay where they are while the camera moves.
    const glm::ivec2 middle = (input.culling.cell >> step_log2_) << step_log2_;
    const glm::ivec2 first = middle - tiles_a_side * (side / 2);
    for (int row = 0; row < tiles_a_side; ++row)
        for (int column = 0; column < tiles_a_side; ++column) {
            const glm::ivec2 corner = first + glm::ivec2(column, row) * side;
            const LatticePoint absolute{input.culling.anchor.x + corner.x, input.culling.anchor.z + corner.y};
            if (may_see(input.planes,
                        bounds_of_square(input.culling, absolute, side, waves.height, waves.displacement)))
                tiles_.push_back(corner);
        }
    const auto rings_away = [&](glm::ivec2 corner) {
        return std::max(std::abs(corner.x + side / 2 - middle.x), std::abs(corner.y + side / 2 - middle.y));
    };
    // Nearest first: what lies behind then fails the depth test before it costs a fragment.
    std::sort(tiles_.begin(), tiles_.end(), [&](glm::ivec2 a, glm::ivec2 b) {
        return std::tuple(rings_away(a), a.y, a.x) < std::tuple(rings_away(b), b.y, b.x);
    });
    corners_.fill(GL_ARRAY_BUFFER, std::span<const glm::ivec2>(tiles_), GL_STREAM_DRAW);
    const float cell = static_cast<float>(1 << step_log2_) * 0x1p-10F;
    // The camera stands up to a cell off the middle.
    const float reach = (static_cast<float>(tiles_a_side * tile_cells) * 0.5F - 1.0F) * cell;
    edge_ = {fading_from * reach, 1.0F / ((1.0F - fading_from) * reach)};
    constexpr uint32_t triangles_a_tile = 2 * tile_cells * tile_cells;
    tiles_a_draw_ = std::max(1U, input.options.triangles_per_draw / triangles_a_tile);
    const auto count = static_cast<uint32_t>(tiles_.size());
    return {0, count * triangles_a_tile,
            static_cast<uint32_t>((tiles_.size() + tiles_a_draw_ - 1) / tiles_a_draw_)};
}

void UniformMesher::bind() {
    layout_.bind();
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.name());
    glBindBuffer(GL_ARRAY_BUFFER, corners_.name());
    program_.use();
}

void UniformMesher::draw() {
    glUniform2i(shape_uniform_, step_log2_, tile_cells + 1);
    glUniform2f(edge_uniform_, edge_.x, edge_.y);
    glBindBuffer(GL_ARRAY_BUFFER, corners_.name());
    for (size_t first = 0; first < tiles_.size(); first += tiles_a_draw_) {
        const size_t count = std::min(tiles_a_draw_, tiles_.size() - first);
        glVertexAttribIPointer(0, 2, GL_INT, sizeof(glm::ivec2), buffer_offset(first * sizeof(glm::ivec2)));
        glDrawElementsInstanced(GL_TRIANGLES, index_count_, GL_UNSIGNED_SHORT, nullptr,
                                static_cast<GLsizei>(count));
        if (count == tiles_a_draw_) begin_drawing();
    }
}

}  // namespace trochoid
