#include "client/gpu/uniform_mesher.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace trochoid {

namespace {

/// Cells along a side of a tile, drawn by one call.
constexpr int tile_cells = 32;

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
    : program_(stages_of(use, {"uniform.vert"}), options_of(use)), tile_uniform_(program_.uniform("tile")) {
    layout_.bind();
    const std::vector<uint16_t> indices = tile_indices();
    indices_.fill(GL_ELEMENT_ARRAY_BUFFER, std::span<const uint16_t>(indices), GL_STATIC_DRAW);
    index_count_ = static_cast<GLsizei>(indices.size());
}

MeshCounts UniformMesher::prepare(const MesherInput& input) {
    step_log2_ = step_log2_of(input.options.grid_spacing_m);
    const int side = tile_cells << step_log2_;
    const int tiles_a_side = (static_cast<int>(input.options.grid_cells) + tile_cells - 1) / tile_cells;
    const WaveBounds waves = input.table.bounds_of_list(0);
    tiles_.clear();
    // On whole cells, so that vertices stay where they are while the camera moves.
    const glm::ivec2 first = ((input.culling.cell >> step_log2_) << step_log2_) - tiles_a_side * (side / 2);
    for (int row = 0; row < tiles_a_side; ++row)
        for (int column = 0; column < tiles_a_side; ++column) {
            const glm::ivec2 corner = first + glm::ivec2(column, row) * side;
            const LatticePoint absolute{input.culling.anchor.x + corner.x, input.culling.anchor.z + corner.y};
            if (may_see(input.planes,
                        bounds_of_square(input.culling, absolute, side, waves.height, waves.displacement)))
                tiles_.push_back(corner);
        }
    const auto count = static_cast<uint32_t>(tiles_.size());
    return {0, count * 2 * tile_cells * tile_cells, count};
}

void UniformMesher::bind() {
    layout_.bind();
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.name());
    program_.use();
}

void UniformMesher::draw() {
    for (const glm::ivec2 corner : tiles_) {
        glUniform4i(tile_uniform_, corner.x, corner.y, step_log2_, tile_cells + 1);
        glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_SHORT, nullptr);
    }
}

}  // namespace trochoid
