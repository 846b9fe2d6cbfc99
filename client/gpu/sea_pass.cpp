#include "client/gpu/sea_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/vec2.hpp>

namespace trochoid {

namespace {

constexpr uint32_t ripple_side = 256;

void upload_ripples(const GlTexture& texture, const RippleMap& map) {
    texture.bind(GL_TEXTURE_2D, ripples_unit);
    auto side = static_cast<GLsizei>(map.side);
    for (size_t level = 0; level < map.levels.size(); ++level, side = std::max(side / 2, 1))
        glTexImage2D(GL_TEXTURE_2D, static_cast<GLint>(level), GL_RGBA16F, side, side, 0, GL_RGBA, GL_FLOAT,
                     map.levels[level].data());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
}

}  // namespace

SeaBuffers::SeaBuffers() {
    upload_ripples(ripples_, make_ripple_map(ripple_side, 5));
    const std::vector<RecordTexel> wakes = wake_texels();
    wakes_.fill(std::span(wakes), GL_STATIC_DRAW);
    set_bed(BedMap{});
    set_land(LandTable{});
    set_records({});
    set_lists({});
}

void SeaBuffers::set_records(const std::vector<RecordTexel>& records) {
    records_.fill(std::span(records), GL_STREAM_DRAW);
}
void SeaBuffers::set_lists(const std::vector<ListTexel>& lists) {
    lists_.fill(std::span(lists), GL_DYNAMIC_DRAW);
}

void SeaBuffers::set_land(const LandTable& land) {
    slots_.fill(std::span(land.slots()), GL_DYNAMIC_DRAW);
    nodes_.fill(std::span(land.nodes()), GL_DYNAMIC_DRAW);
}

void SeaBuffers::set_bed(const BedMap& bed) {
    bed_.bind(GL_TEXTURE_2D, bed_unit);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, static_cast<GLsizei>(bed.columns), static_cast<GLsizei>(bed.rows),
                 0, GL_RED, GL_FLOAT, bed.heights.data());
    for (const auto axis : std::array<GLenum, 2>{GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        glTexParameteri(GL_TEXTURE_2D, axis, GL_CLAMP_TO_EDGE);
    for (const auto filter : std::array<GLenum, 2>{GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
}

void SeaBuffers::bind() const {
    records_.bind(records_unit);
    lists_.bind(lists_unit);
    slots_.bind(slots_unit);
    nodes_.bind(nodes_unit);
    wakes_.bind(wakes_unit);
    ripples_.bind(GL_TEXTURE_2D, ripples_unit);
    bed_.bind(GL_TEXTURE_2D, bed_unit);
}

SeaPass::SeaPass() {
    quads_layout_.bind();
    glBindBuffer(GL_ARRAY_BUFFER, quads_.name());
    glEnableVertexAttribArray(0);
    glVertexAttribIPointer(0, 4, GL_INT, sizeof(SeaQuad), nullptr);
}

void SeaPass::draw(const SeaMesh& mesh, bool wireframe) {
    quads_.fill(GL_ARRAY_BUFFER, std::span(mesh.quads), GL_STREAM_DRAW);
    quads_layout_.bind();
    program_.use();
    glPatchParameteri(GL_PATCH_VERTICES, 1);
    // Behind land too: the far sea must not show through where a patch is merely hidden.
    glEnable(GL_STENCIL_TEST);
    glStencilFunc(GL_ALWAYS, 1, 0xff);
    glStencilOp(GL_KEEP, GL_REPLACE, GL_REPLACE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    if (wireframe) glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    for (const SeaBatch& batch : mesh.batches)
        glDrawArrays(GL_PATCHES, static_cast<GLint>(batch.first), static_cast<GLsizei>(batch.count));
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glDisable(GL_BLEND);
    glDisable(GL_STENCIL_TEST);
}

FarSeaPass::FarSeaPass() {
    layout_.bind();
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(glm::vec2), nullptr);
}

void FarSeaPass::draw(float radius_m) {
    constexpr uint32_t sectors = 64;
    constexpr uint32_t rings = 30;
    layout_.bind();
    if (radius_m != radius_m_) {
        radius_m_ = radius_m;
        std::vector<glm::vec2> vertices;
        std::vector<uint16_t> indices;
        for (uint32_t ring = 0; ring <= rings; ++ring)
            for (uint32_t sector = 0; sector <= sectors; ++sector) {
                // 0, then from 30 m outwards by equal ratios.
                const double share = static_cast<double>(ring) / rings;
                const double r =
                    ring == 0 ? 0.0 : 30.0 * std::pow(static_cast<double>(radius_m) / 30.0, share);
                vertices.emplace_back(static_cast<float>(r),
                                      static_cast<float>(6.283185307179586 * sector / sectors));
            }
        for (uint32_t ring = 0; ring < rings; ++ring)
            for (uint32_t sector = 0; sector < sectors; ++sector) {
                const auto a = static_cast<uint16_t>(ring * (sectors + 1) + sector);
                const auto b = static_cast<uint16_t>(a + sectors + 1);
                for (const uint16_t i : {a, b, static_cast<uint16_t>(a + 1), static_cast<uint16_t>(a + 1), b,
                                         static_cast<uint16_t>(b + 1)})
                    indices.push_back(i);
            }
        vertices_.fill(GL_ARRAY_BUFFER, std::span<const glm::vec2>(vertices), GL_STATIC_DRAW);
        indices_.fill(GL_ELEMENT_ARRAY_BUFFER, std::span<const uint16_t>(indices), GL_STATIC_DRAW);
        index_count_ = static_cast<GLsizei>(indices.size());
    }
    program_.use();
    glEnable(GL_STENCIL_TEST);
    glStencilFunc(GL_NOTEQUAL, 1, 0xff);
    glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.name());
    glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_SHORT, nullptr);
    glDisable(GL_STENCIL_TEST);
}

}  // namespace trochoid
