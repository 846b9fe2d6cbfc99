#include "client/scene/patch_directory.hpp"

#include <algorithm>
#include <bit>

namespace trochoid {

namespace {

uint32_t hash_of(uint32_t level, uint32_t x, uint32_t z) {
    uint32_t h = x * 0x9e3779b9U ^ z * 0x85ebca6bU ^ level * 0xc2b2ae35U;
    h = (h ^ (h >> 15U)) * 0x2c1b3c6dU;
    return h ^ (h >> 13U);
}

uint32_t low_bits(int64_t v) { return static_cast<uint32_t>(static_cast<uint64_t>(v)); }

}  // namespace

void PatchDirectory::rebuild(const InterestState& state, const SeaTable& table) {
    const auto slots = std::bit_ceil(std::max<uint32_t>(8, 2 * static_cast<uint32_t>(state.patches.size())));
    int finest = 31;
    int coarsest = 0;
    texels_.assign(size_t{slots} + 1, RecordTexel{-1, 0, 0, 0});
    for (const auto& [key, patch] : state.patches) {
        const uint32_t level = key.level;
        finest = std::min(finest, int{key.level});
        coarsest = std::max(coarsest, int{key.level});
        const uint32_t x = low_bits(int64_t{key.x} << level) >> level;
        const uint32_t z = low_bits(int64_t{key.z} << level) >> level;
        uint32_t slot = hash_of(level, x, z) & (slots - 1);
        while (texels_[slot + 1][0] >= 0) slot = (slot + 1) & (slots - 1);
        texels_[slot + 1] = {key.level, std::bit_cast<int32_t>(x), std::bit_cast<int32_t>(z),
                             table.list_of(key)};
    }
    texels_[0] = {static_cast<int32_t>(slots), finest, coarsest, 0};
}

int PatchDirectory::list_at(uint32_t x_low, uint32_t z_low) const {
    const auto slots = static_cast<uint32_t>(texels_[0][0]);
    for (int level = texels_[0][1]; level <= texels_[0][2]; ++level) {
        const uint32_t x = x_low >> level;
        const uint32_t z = z_low >> level;
        uint32_t slot = hash_of(static_cast<uint32_t>(level), x, z) & (slots - 1);
        for (; texels_[slot + 1][0] >= 0; slot = (slot + 1) & (slots - 1)) {
            const RecordTexel& texel = texels_[slot + 1];
            if (texel[0] == level && std::bit_cast<uint32_t>(texel[1]) == x &&
                std::bit_cast<uint32_t>(texel[2]) == z)
                return texel[3];
        }
    }
    return 0;
}

}  // namespace trochoid
