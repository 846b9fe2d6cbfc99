#include "client/gpu/land_pass.hpp"

#include <cmath>

namespace trochoid {

namespace {

/// Frames after which a tile that nobody drew leaves the GPU.
constexpr uint64_t patience_frames = 300;

}  // namespace

LandPass::LandPass()
    : tile_uniform_(program_.uniform("tile")), height_unit_uniform_(program_.uniform("height_unit")) {
    for (uint32_t quadrant = 0; quadrant < 4; ++quadrant)
        for (uint32_t i = 0; i < terrain_strides; ++i) {
            const std::vector<uint16_t> list = terrain_indices(quadrant, 1U << i);
            Indices& indices = indices_[quadrant][i];
            glBindVertexArray(0);
            indices.buffer.fill(GL_ARRAY_BUFFER, std::span(list), GL_STATIC_DRAW);
            indices.count = static_cast<GLsizei>(list.size());
        }
}

LandPass::Tile& LandPass::tile_of(const std::shared_ptr<const TerrainTile>& source) {
    std::unique_ptr<Tile>& tile = tiles_[source.get()];
    if (!tile) {
        tile = std::make_unique<Tile>();
        tile->source = source;
        const std::vector<TerrainVertex> vertices = terrain_vertices_of(*source);
        tile->layout.bind();
        tile->vertices.fill(GL_ARRAY_BUFFER, std::span(vertices), GL_STATIC_DRAW);
        glEnableVertexAttribArray(0);
        glVertexAttribIPointer(0, 2, GL_SHORT, sizeof(TerrainVertex), nullptr);
        glEnableVertexAttribArray(1);
        glVertexAttribPointer(1, 3, GL_BYTE, GL_TRUE, sizeof(TerrainVertex),
                              buffer_offset(offsetof(TerrainVertex, nx)));
    }
    return *tile;
}

void LandPass::drop_unused() {
    for (auto at = tiles_.begin(); at != tiles_.end();) {
        if (at->second->last_frame + patience_frames < frame_)
            at = tiles_.erase(at);
        else
            ++at;
    }
}

void LandPass::draw(const TerrainSelection& selection, const CameraFrame& frame, bool wireframe) {
    ++frame_;
    program_.use();
    if (wireframe) glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    for (const TerrainDraw& draw : selection.draws) {
        Tile& tile = tile_of(draw.tile);
        tile.last_frame = frame_;
        tile.layout.bind();
        const int64_t x = draw.tile->origin_x - frame.anchor.x;
        const int64_t z = draw.tile->origin_z - frame.anchor.z;
        const int64_t side = int64_t{terrain_tile_cells} << draw.tile->spacing_log2;
        if (std::max(std::abs(x), std::abs(z)) + side > anchor_reach) continue;
        // A skirt as deep as its cells are wide hides any step between neighbours of unequal level.
        const auto skirt = static_cast<GLint>((int64_t{1} << draw.tile->spacing_log2 << draw.stride_log2) /
                                              lattice_per_metre);
        glUniform4i(tile_uniform_, static_cast<GLint>(x), static_cast<GLint>(z),
                    static_cast<GLint>(draw.tile->spacing_log2), skirt);
        glUniform1f(height_unit_uniform_, std::ldexp(1.0F, draw.tile->height_step_log2 - 10));
        const Indices& indices = indices_[draw.quadrant][draw.stride_log2];
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices.buffer.name());
        glDrawElements(GL_TRIANGLES, indices.count, GL_UNSIGNED_SHORT, nullptr);
    }
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    drop_unused();
}

}  // namespace trochoid
