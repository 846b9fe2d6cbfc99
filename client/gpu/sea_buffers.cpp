#include "client/gpu/sea_buffers.hpp"

#include <algorithm>
#include <array>

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
    set_directory(PatchDirectory{});
}

void SeaBuffers::set_records(const std::vector<RecordTexel>& records) {
    records_.fill(std::span(records), GL_STREAM_DRAW);
}
void SeaBuffers::set_lists(const std::vector<ListTexel>& lists) {
    lists_.fill(std::span(lists), GL_DYNAMIC_DRAW);
}

void SeaBuffers::set_directory(const PatchDirectory& directory) {
    directory_.fill(std::span(directory.texels()), GL_DYNAMIC_DRAW);
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

void SeaBuffers::set_smaller_filter(GLenum filter) {
    ripples_.bind(GL_TEXTURE_2D, ripples_unit);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(filter));
}

void SeaBuffers::bind() const {
    records_.bind(records_unit);
    lists_.bind(lists_unit);
    directory_.bind(directory_unit);
    slots_.bind(slots_unit);
    nodes_.bind(nodes_unit);
    wakes_.bind(wakes_unit);
    ripples_.bind(GL_TEXTURE_2D, ripples_unit);
    bed_.bind(GL_TEXTURE_2D, bed_unit);
}

}  // namespace trochoid
