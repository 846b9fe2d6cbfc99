// Which list acts at a place: twin of PatchDirectory (client/scene/patch_directory.cpp).
uniform isamplerBuffer patch_directory;  // RGBA32I: slots, finest, coarsest level; then level, x, z, list

uint patch_hash(uint level, uvec2 p) {
    uint h = p.x * 0x9e3779b9u ^ p.y * 0x85ebca6bu ^ level * 0xc2b2ae35u;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    return h ^ (h >> 13);
}

/// List of the finest patch over a place relative to the anchor; 0, which is every box and train, outside of all.
int list_at(ivec2 place) {
    ivec4 head = texelFetch(patch_directory, 0);
    uvec2 low = uvec2(camera_cell.zw + place);
    uint mask = uint(head.x) - 1u;
    for (int level = head.y; level <= head.z; ++level) {
        uvec2 key = low >> level;
        uint slot = patch_hash(uint(level), key) & mask;
        for (;;) {
            ivec4 texel = texelFetch(patch_directory, int(slot) + 1);
            if (texel.x < 0) break;
            if (texel.x == level && uint(texel.y) == key.x && uint(texel.z) == key.y) return texel.w;
            slot = (slot + 1u) & mask;
        }
    }
    return 0;
}
