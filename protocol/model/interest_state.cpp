#include "protocol/model/interest_state.hpp"

#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {

namespace {

void add(Hash64& hash, const ViewState& v) {
    hash.i64(v.position.x).i64(v.position.z).i32(v.altitude);
    hash.f32(v.qx).f32(v.qy).f32(v.qz).f32(v.qw).f32(v.tan_half_width).f32(v.tan_half_height);
    hash.u16(v.viewport_width).u16(v.viewport_height).f32(v.vx).f32(v.vy).f32(v.vz);
    hash.f32(v.accepted_error_px).u32(v.patch_budget);
}

void add(Hash64& hash, const WaveTrain& t) {
    hash.i32(t.kx).i32(t.kz).u64(t.omega).u32(t.phase).f32(t.amplitude).f32(t.choppiness).u32(t.field.value);
}

void add(Hash64& hash, const CourseLeg& leg) {
    hash.i64(leg.from.us).i64(leg.duration_us).i64(leg.origin.x).i64(leg.origin.z).i32(leg.vx).i32(leg.vz);
}

void add(Hash64& hash, const IrregularHeight& i) {
    hash.u16(i.share).i32(i.ukx).i32(i.ukz).i32(i.vkx).i32(i.vkz).u64(i.omega).u32(i.phase_u).u32(i.phase_v);
}

void add(Hash64& hash, const SurfaceNoise& n) {
    hash.f32(n.amplitude).u16(n.persistence).u8(n.octaves).u8(n.step_log2).u8(n.period_log2);
    hash.u8(n.displayed_only ? 1 : 0).u32(n.seed);
}

void add(Hash64& hash, const ShipWake& w) {
    hash.f32(w.transverse).f32(w.diverging).f32(w.choppiness).u32(w.inverse_length).u32(w.group_speed);
}

void add(Hash64& hash, const PatchDescriptor& p) {
    hash.u8(p.key.level).i32(p.key.x).i32(p.key.z).u32(static_cast<uint32_t>(p.boxes.size()));
    for (const PatchBox& b : p.boxes) hash.u32(b.box.value).u16(b.train_count);
    hash.f32(p.left_out).f32(p.height_error);
}

bool same(const std::shared_ptr<const WaveTrainBox>& a, const std::shared_ptr<const WaveTrainBox>& b) {
    return a == b || *a == *b;
}

bool same(const FieldBlock& a, const FieldBlock& b) {
    if (a.step_log2 != b.step_log2) return false;
    return a.block == b.block || *a.block == *b.block;
}

bool same(const PatchDescriptor& a, const PatchDescriptor& b) { return a == b; }

/// Walks two maps side by side: values of `target` that `base` lacks or has otherwise, and keys that `target` lacks.
template <class Key, class Value>
void compare(const std::map<Key, Value>& base, const std::map<Key, Value>& target,
             std::vector<Value>& changed, std::vector<Key>& removed) {
    auto old = base.begin();
    for (const auto& [key, value] : target) {
        for (; old != base.end() && old->first < key; ++old) removed.push_back(old->first);
        const bool known = old != base.end() && old->first == key;
        if (!known || !same(old->second, value)) changed.push_back(value);
        if (known) ++old;
    }
    for (; old != base.end(); ++old) removed.push_back(old->first);
}

}  // namespace

LatticeRect rect_of(PatchKey key) {
    const int64_t side = int64_t{1} << key.level;
    const LatticePoint min{key.x * side, key.z * side};
    return {min, {min.x + side, min.z + side}};
}

PatchKey patch_at(LatticePoint p, uint8_t level) {
    return {level, static_cast<int32_t>(p.x >> level), static_cast<int32_t>(p.z >> level)};
}

uint64_t hash_of(const CullKey& key) {
    Hash64 hash;
    add(hash, key.anchor);
    hash.u32(key.slack).f32(key.slack_tangent).f32(key.error_in_force_px).u32(key.patch_limit);
    hash.u32(static_cast<uint32_t>(key.regions.size()));
    for (const SyncRegion& r : key.regions) hash.i64(r.centre.x).i64(r.centre.z).u32(r.radius);
    return hash.u64(key.log_position.value).i64(key.from.us).i64(key.until.us).value();
}

uint64_t hash_of(const WaveTrainBox& box) {
    Hash64 hash;
    hash.u32(box.id.value).u32(box.first_train.value).i64(box.origin.x).i64(box.origin.z);
    hash.i32(box.ux).i32(box.uz).i64(box.length).i64(box.width);
    hash.i32(box.ramp_rear).i32(box.ramp_front).i32(box.ramp_side);
    hash.i64(box.begin.us).i64(box.build_up_us).i64(box.end.us).i64(box.decay_us);
    hash.u32(box.front_speed).u16(box.gain_max).i64(box.raised_us).i64(box.fade_us).u16(box.roundness);
    hash.u32(static_cast<uint32_t>(box.trains.size()));
    for (const WaveTrain& train : box.trains) add(hash, train);
    hash.u32(static_cast<uint32_t>(box.overlays.size()));
    for (const FieldOverlay& o : box.overlays) hash.u32(o.field.value).u32(o.base.value);
    hash.u32(static_cast<uint32_t>(box.course.size()));
    for (const CourseLeg& leg : box.course) add(hash, leg);
    add(hash, box.irregular);
    add(hash, box.noise);
    add(hash, box.wake);
    return hash.value();
}

uint64_t hash_of(const LandBlock& block) {
    Hash64 hash;
    hash.i32(block.key.x).i32(block.key.z);
    for (const int32_t s : block.shift) hash.i32(s);
    for (const uint16_t g : block.gain) hash.u16(g);
    for (const uint16_t o : block.orbit) hash.u16(o);
    return hash.value();
}

uint64_t hash_of(const InterestState& state) {
    Hash64 hash;
    hash.u32(static_cast<uint32_t>(state.boxes.size()));
    for (const auto& [id, box] : state.boxes) hash.u64(hash_of(*box));
    hash.u32(static_cast<uint32_t>(state.blocks.size()));
    for (const auto& [key, b] : state.blocks) {
        hash.u32(key.field.value).i32(key.block.x).i32(key.block.z).u8(b.step_log2);
        hash.u64(b.content != 0 ? b.content : hash_of(*b.block));
    }
    hash.u32(static_cast<uint32_t>(state.patches.size()));
    for (const auto& [key, patch] : state.patches) add(hash, patch);
    return hash.value();
}

InterestDelta difference(const InterestState& base, const InterestState& target) {
    InterestDelta delta;
    compare(base.boxes, target.boxes, delta.boxes, delta.removed_boxes);
    compare(base.blocks, target.blocks, delta.blocks, delta.removed_blocks);
    compare(base.patches, target.patches, delta.patches, delta.removed_patches);
    return delta;
}

void apply(InterestState& state, const InterestDelta& delta) {
    for (const BoxId id : delta.removed_boxes) state.boxes.erase(id);
    for (const FieldBlockKey& key : delta.removed_blocks) state.blocks.erase(key);
    for (const PatchKey& key : delta.removed_patches) state.patches.erase(key);
    for (const auto& box : delta.boxes) {
        TROCHOID_ASSERT(box != nullptr, "a delta holds a box without a record");
        state.boxes[box->id] = box;
    }
    for (FieldBlock block : delta.blocks) {
        TROCHOID_ASSERT(block.block != nullptr, "a delta holds a block of field {} without nodes",
                        block.field.value);
        if (block.content == 0) block.content = hash_of(*block.block);
        state.blocks[{block.field, block.block->key}] = std::move(block);
    }
    for (const PatchDescriptor& patch : delta.patches) state.patches[patch.key] = patch;
}

}  // namespace trochoid
