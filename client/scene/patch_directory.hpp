#pragma once
#include <cstdint>
#include <vector>

#include "client/scene/sea_table.hpp"
#include "protocol/model/interest_state.hpp"

namespace trochoid {

/// Which list of boxes and trains acts at a place, for meshes that do not know the server's patches: a table of open
/// addressing over the patches of a state, as shaders/patch_directory.glsl reads it. Keys hold the low 32 bits of the patches'
/// corners, so places farther apart than 2^32 lattice units (4,194 km) would be confused; no view reaches that far.
class PatchDirectory {
public:
    /// Without patches every place has list 0.
    PatchDirectory() { rebuild({}, {}); }
    void rebuild(const InterestState& state, const SeaTable& table);

    /// Twin of list_at in the shader: the list of the finest patch over a place given by its low 32 bits, 0 outside of all.
    int list_at(uint32_t x_low, uint32_t z_low) const;

    /// First texel: slots (a power of two), finest level, coarsest level, 0. Then the slots: level (-1 = free), corner's low bits
    /// shifted right by it (x, z), list.
    const std::vector<RecordTexel>& texels() const { return texels_; }

private:
    std::vector<RecordTexel> texels_;
};

}  // namespace trochoid
