#pragma once
#include "client/gpu/gl_objects.hpp"
#include "client/gpu/shader_program.hpp"
#include "client/scene/bed_map.hpp"
#include "client/scene/patch_directory.hpp"
#include "client/scene/ripple_map.hpp"
#include "client/scene/sea_table.hpp"

namespace trochoid {

/// The tables of the sea on the GPU, shared by all passes that evaluate it.
class SeaBuffers {
public:
    SeaBuffers();
    /// Every frame: rows with this moment's phases and envelopes.
    void set_records(const std::vector<RecordTexel>& records);
    /// When the state changes.
    void set_lists(const std::vector<ListTexel>& lists);
    void set_directory(const PatchDirectory& directory);
    void set_land(const LandTable& land);
    void set_bed(const BedMap& bed);
    /// Of the ripples, where they are smaller than their finest level.
    void set_smaller_filter(GLenum filter);
    void bind() const;

private:
    GlTexelBuffer records_{GL_RGBA32I};
    GlTexelBuffer lists_{GL_RG32I};
    GlTexelBuffer directory_{GL_RGBA32I};
    GlTexelBuffer slots_{GL_R32I};
    GlTexelBuffer nodes_{GL_RG32I};
    GlTexelBuffer wakes_{GL_RGBA32I};
    GlTexture ripples_;
    GlTexture bed_;
};

}  // namespace trochoid
