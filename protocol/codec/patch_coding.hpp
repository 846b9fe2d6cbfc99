#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/codec/codec.hpp"
#include "protocol/codec/scrutiny.hpp"

namespace trochoid {

/// Ids of the boxes that patches name, ascending: the `box_ids` of a delta whose patches travel as planes.
std::vector<uint32_t> boxes_named(std::span<const PatchDescriptor> patches);

/// The patches that a delta sets and removes as planes of one column (protocol/README.md, "State, deltas, acknowledgements").
/// Both ascend by key; box_ids are those of boxes_named.
Bytes code_patches(const InterestDelta& change, std::span<const uint32_t> box_ids);

/// Reads them to the end of `planes`. Refused unless all is in order and in range; ids that no patch has are read over.
void unpack_patches(Scrutiny& check, std::span<const uint8_t> planes, std::span<const uint32_t> box_ids,
                    InterestDelta& change);

/// Patches that one delta may remove, in either form.
inline constexpr int32_t most_removed_patches = 65536;

/// Entries of boxes that the patches of one delta may have together, in either form.
inline constexpr size_t most_patch_boxes = 65536;

}  // namespace trochoid
