#include "tests/conformance/held_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace trochoid::conformance {

namespace {

template <class... Arguments>
void require(bool holds, fmt::format_string<Arguments...> sentence, Arguments&&... arguments) {
    if (!holds) throw Failed{fmt::format(sentence, std::forward<Arguments>(arguments)...)};
}

}  // namespace

void HeldState::adopt(const InterestState& state) {
    state_ = state;
    hash_ = hash_of(state_);
    result_ = begun_ = 1;
    snapshot_due_ = false;
}

void HeldState::take_turn(const Delta& piece) {
    if (whole_) {
        require(piece.result == begun_ + 1, "R-134: result {} came after result {}", piece.result, begun_);
        require(piece.piece == 0, "R-134: result {} begins with piece {}", piece.result, piece.piece);
    } else {
        require(piece.result == begun_, "R-134: result {} began before the last piece of result {}",
                piece.result, begun_);
        require(piece.piece == next_piece_, "R-134: piece {} of result {} came where piece {} was due",
                piece.piece, piece.result, next_piece_);
        require(piece.base == base_ && piece.base_hash == base_hash_,
                "R-134: the pieces of result {} name two bases", piece.result);
        require(piece.key == key_, "R-134: the pieces of result {} name two keys", piece.result);
    }
}

void HeldState::take_base(const Delta& piece) {
    base_ = piece.base;
    base_hash_ = piece.base_hash;
    key_ = piece.key;
    passing_by_ = false;
    if (base_ == 0) {
        state_ = {};
        ++snapshots_;
        snapshot_due_ = snapshot_awaited_ = false;
        return;
    }
    require(!snapshot_due_, "R-134: result {} builds on result {}, but nothing was sent to build on",
            piece.result, base_);
    if (snapshot_awaited_) {
        passing_by_ = true;
        return;
    }
    require(base_ == result_, "R-134: result {} builds on result {}, not on {}, the last one applied",
            piece.result, base_, result_);
    require(base_hash_ == hash_, "R-133: result {} names the hash {:016x} for its base, which has {:016x}",
            piece.result, base_hash_, hash_);
}

void HeldState::check_change(const Delta& piece) const {
    const InterestDelta& change = piece.change;
    for (const BoxId id : change.removed_boxes)
        require(state_.boxes.contains(id), "R-134: box {} is removed but was not held", id.value);
    for (const FieldBlockKey& key : change.removed_blocks)
        require(state_.blocks.contains(key), "R-134: a block of field {} is removed but was not held",
                key.field.value);
    for (const PatchKey& key : change.removed_patches)
        require(state_.patches.contains(key), "R-134: patch ({}, {}) of level {} is removed but was not held",
                key.x, key.z, key.level);
}

bool HeldState::take(const Delta& piece) {
    take_turn(piece);
    if (piece.piece == 0) take_base(piece);
    ++pieces_;
    begun_ = piece.result;
    whole_ = piece.last;
    next_piece_ = static_cast<uint16_t>(piece.piece + 1);
    if (!passing_by_) {
        check_change(piece);
        apply(state_, piece.change);
    }
    if (piece.last && !passing_by_) finish(piece);
    if (piece.last && passing_by_) result_ = piece.result;
    return piece.last;
}

void HeldState::finish(const Delta& piece) {
    result_ = piece.result;
    hash_ = hash_of(state_);
    require(hash_ == piece.state_hash,
            "R-133: after result {} the state hashes to {:016x}, but the server says {:016x}", result_, hash_,
            piece.state_hash);
    check_state(state_, piece.key);
    last_ = piece;
}

namespace {

void check_patch(const InterestState& state, const PatchDescriptor& patch) {
    const auto name = [&] {
        return fmt::format("patch ({}, {}) of level {}", patch.key.x, patch.key.z, patch.key.level);
    };
    require(std::isfinite(patch.left_out) && patch.left_out >= 0.0F, "R-117: {}: left_out is {}", name(),
            patch.left_out);
    require(std::isfinite(patch.height_error) && patch.height_error >= 0.0F, "R-117: {}: height_error is {}",
            name(), patch.height_error);
    BoxId before;
    for (const PatchBox& entry : patch.boxes) {
        require(entry.box > before, "R-117: the boxes of {} do not ascend", name());
        before = entry.box;
        const auto box = state.boxes.find(entry.box);
        require(box != state.boxes.end(), "R-134: {} names box {}, which is not held", name(),
                entry.box.value);
        require(entry.train_count <= box->second->trains.size(),
                "R-117: {} names {} trains of box {}, which has {}", name(), entry.train_count,
                entry.box.value, box->second->trains.size());
    }
}

/// Two squares of a quadtree overlap only where one is the other's ancestor.
void check_patches_apart(const InterestState& state) {
    for (const auto& [key, patch] : state.patches)
        for (uint8_t level = static_cast<uint8_t>(key.level + 1); level <= coarsest_patch_level; ++level) {
            const int up = level - key.level;
            const PatchKey ancestor{level, key.x >> up, key.z >> up};
            require(!state.patches.contains(ancestor),
                    "R-134: patch ({}, {}) of level {} lies within another of level {}", key.x, key.z,
                    key.level, level);
        }
}

}  // namespace

void check_state(const InterestState& state, const CullKey& key) {
    std::set<FieldId> read;
    for (const auto& [id, box] : state.boxes) {
        for (const WaveTrain& train : box->trains) read.insert(train.field);
        for (const FieldOverlay& overlay : box->overlays) {
            read.insert(overlay.field);
            read.insert(overlay.base);
        }
    }
    for (const auto& [place, block] : state.blocks)
        require(read.contains(place.field), "R-134: a block of field {} is held, but no box reads that field",
                place.field.value);
    require(state.patches.size() <= key.patch_limit, "R-134: {} patches, but the key's limit is {}",
            state.patches.size(), key.patch_limit);
    for (const auto& [place, patch] : state.patches) check_patch(state, patch);
    check_patches_apart(state);
}

}  // namespace trochoid::conformance
