#pragma once
#include <compare>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "protocol/model/land_field.hpp"
#include "protocol/model/view.hpp"
#include "protocol/model/wave_train_box.hpp"

namespace trochoid {

/// A quadtree patch of the sea: the square [x, x+1) × [z, z+1) in units of 2^level lattice units (level 16 = 64 m).
struct PatchKey {
    uint8_t level = 16;
    int32_t x = 0;
    int32_t z = 0;
    auto operator<=>(const PatchKey&) const = default;
};
inline constexpr uint8_t finest_patch_level = 15;    // 32 m
inline constexpr uint8_t coarsest_patch_level = 26;  // 65.5 km
/// The closed square: max is the neighbours' min, so that surfaces agree on their common edge.
LatticeRect rect_of(PatchKey key);
/// The patch of a level that holds the point.
PatchKey patch_at(LatticePoint p, uint8_t level);

/// One box as a patch sees it: the first train_count trains of the box (by falling wavelength); the others' displayed
/// gain is 0 on the whole closed patch for every camera within the anchor's slack.
struct PatchBox {
    BoxId box;
    uint16_t train_count = 0;
    auto operator<=>(const PatchBox&) const = default;
};

/// What a client is told of one patch. Boxes by ascending id.
struct PatchDescriptor {
    PatchKey key;
    std::vector<PatchBox> boxes;
    float left_out = 0.0F;      ///< E = sum of A * g_max of what was left out over patch and span, m
    float height_error = 0.0F;  ///< H: bound of the height error at a fixed place, m
    bool operator==(const PatchDescriptor&) const = default;
};

/// What the server decided a result from; every result is a pure function of its key (and of the log).
struct CullKey {
    ViewState anchor;            ///< camera of the decision
    uint32_t slack = 0;          ///< camera may move this far (lattice units) before the result stops holding
    float slack_tangent = 0.0F;  ///< and turn by this tangent
    float error_in_force_px = 1.0F;
    uint32_t patch_limit = 512;
    std::vector<SyncRegion> regions;
    LogPosition log_position;
    SeaTime from;  ///< span of sea time that the bounds hold for
    SeaTime until;
    bool operator==(const CullKey&) const = default;
};
uint64_t hash_of(const CullKey& key);

/// Boxes that ended longer ago than this, before the key's span, are not kept for sync regions: how far lag compensation
/// may look back.
inline constexpr int64_t sync_history_us = int64_t{600} * microseconds_per_second;

struct FieldBlockKey {
    FieldId field;
    BlockKey block;
    auto operator<=>(const FieldBlockKey&) const = default;
};

/// A land block with the lattice step of its field.
struct FieldBlock {
    FieldId field;
    uint8_t step_log2 = 16;
    std::shared_ptr<const LandBlock> block;
    /// hash_of(*block), so that hashing a state costs no pass over its nodes; 0 = not yet computed (decoders leave it,
    /// apply fills it in). Never on the wire.
    uint64_t content = 0;
};

/// The state a client holds: the server keeps the same value as the base of its deltas.
struct InterestState {
    std::map<BoxId, std::shared_ptr<const WaveTrainBox>> boxes;
    std::map<FieldBlockKey, FieldBlock> blocks;
    std::map<PatchKey, PatchDescriptor> patches;
};

/// Content hashes are endianness-independent; both ends compute them over the same values in map order.
uint64_t hash_of(const WaveTrainBox& box);
uint64_t hash_of(const LandBlock& block);
uint64_t hash_of(const InterestState& state);

/// The change from one state to another; a snapshot is the delta from nothing. May be split in pieces, each of which
/// applies alone.
struct InterestDelta {
    std::vector<std::shared_ptr<const WaveTrainBox>> boxes;  ///< new or replaced, ascending id
    std::vector<BoxId> removed_boxes;
    std::vector<FieldBlock> blocks;
    std::vector<FieldBlockKey> removed_blocks;
    std::vector<PatchDescriptor> patches;  ///< in order of priority (nearest first)
    std::vector<PatchKey> removed_patches;
    bool empty() const {
        return boxes.empty() && removed_boxes.empty() && blocks.empty() && removed_blocks.empty() &&
               patches.empty() && removed_patches.empty();
    }
};

InterestDelta difference(const InterestState& base, const InterestState& target);
void apply(InterestState& state, const InterestDelta& delta);

}  // namespace trochoid
