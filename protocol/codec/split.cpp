#include <algorithm>

#include "protocol/codec/codec.hpp"
#include "protocol/codec/plane_coding.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

// Upper bounds of what an entry adds to an encoding, in bytes. Lists of structs cost exactly their elements; tables cost
// their members, a vtable that is shared at best, and padding. The tests hold them against real encodings.
constexpr size_t lists_cost = 10 * 24;  // ten lists: place in the table, vtable slot, length, padding
constexpr size_t box_cost = 104 + 24 + 24 + 32;
constexpr size_t extras_cost = 24 + 8 + 8 + 16 + 36 + 16 + 20 + 12 + 8;  // members, lengths, structs, padding
constexpr size_t train_cost = 28;
constexpr size_t field_cost = 5;  // an entry of fields and one of field_of_train
constexpr size_t overlay_cost = 8;
constexpr size_t leg_cost = 40;
constexpr size_t block_cost = 16;
constexpr size_t patch_cost = 20;
constexpr size_t patch_box_cost = 4 + 4;  // and perhaps a new entry of box_ids
constexpr size_t name_cost = 12;
constexpr size_t id_cost = 4;

bool plain(const WaveTrainBox& box) {
    return box.raised_us == 0 && box.fade_us == 0 && box.overlays.empty() && box.course.empty() &&
           box.irregular == IrregularHeight{} && box.noise == SurfaceNoise{} && box.wake == ShipWake{} &&
           box.hull == Hull{};
}

size_t cost_of(const WaveTrainBox& box) {
    return box_cost + box.trains.size() * (train_cost + field_cost) + (plain(box) ? 0 : extras_cost) +
           box.overlays.size() * overlay_cost + box.course.size() * leg_cost;
}
size_t cost_of(const FieldBlock& block) { return block_cost + code_nodes(*block.block).size(); }
size_t cost_of(const PatchDescriptor& patch) { return patch_cost + patch.boxes.size() * patch_box_cost; }

/// Fills pieces one after the other.
class Pieces {
public:
    Pieces(const Delta& header, size_t max_bytes) : blank_(header), limit_(max_bytes) {
        blank_.change = {};
        blank_.last = false;
        blank_.state_hash = 0;
        fixed_ = encode(ServerMessage(blank_)).size() + lists_cost;
        begin();
    }

    /// Room for an entry of this cost: in the piece at hand, or else in a new one.
    InterestDelta& room_for(size_t cost) {
        TROCHOID_ASSERT(fixed_ + cost <= limit_,
                        "an entry of {} bytes and the key's {} do not fit a message of {}", cost, fixed_,
                        limit_);
        if (used_ + cost > limit_) begin();
        used_ += cost;
        return pieces_.back().change;
    }

    std::vector<Delta> finish(uint64_t state_hash) {
        pieces_.back().last = true;
        pieces_.back().state_hash = state_hash;
        return std::move(pieces_);
    }

private:
    void begin() {
        TROCHOID_ASSERT(pieces_.size() <= UINT16_MAX, "{} pieces", pieces_.size());
        blank_.piece = static_cast<uint16_t>(pieces_.size());
        pieces_.push_back(blank_);
        used_ = fixed_;
    }

    Delta blank_;
    size_t limit_;
    size_t fixed_ = 0;
    size_t used_ = 0;
    std::vector<Delta> pieces_;
};

LatticeRect rect_of_block(const FieldBlock& block) {
    const int64_t side = int64_t{block_cells} << block.step_log2;
    const LatticePoint min{block.block->key.x * side, block.block->key.z * side};
    return {min, {min.x + side, min.z + side}};
}

/// Every patch right after the blocks under it that have not travelled yet; then the blocks under no patch.
void add_patches_with_blocks(Pieces& pieces, const InterestDelta& change) {
    std::vector<const FieldBlock*> waiting;
    waiting.reserve(change.blocks.size());
    for (const FieldBlock& block : change.blocks) waiting.push_back(&block);
    const auto send = [&](const FieldBlock& block) {
        pieces.room_for(cost_of(block)).blocks.push_back(block);
    };
    for (const PatchDescriptor& patch : change.patches) {
        const LatticeRect place = rect_of(patch.key);
        const auto sent = std::stable_partition(waiting.begin(), waiting.end(), [&](const FieldBlock* b) {
            return !overlap(rect_of_block(*b), place);
        });
        for (auto it = sent; it != waiting.end(); ++it) send(**it);
        waiting.erase(sent, waiting.end());
        pieces.room_for(cost_of(patch)).patches.push_back(patch);
    }
    for (const FieldBlock* block : waiting) send(*block);
}

}  // namespace

std::vector<Delta> split(const Delta& header, const InterestDelta& change, size_t max_bytes) {
    Pieces pieces(header, max_bytes);
    for (const auto& box : change.boxes) pieces.room_for(cost_of(*box)).boxes.push_back(box);
    add_patches_with_blocks(pieces, change);
    for (const PatchKey& key : change.removed_patches)
        pieces.room_for(name_cost).removed_patches.push_back(key);
    for (const FieldBlockKey& key : change.removed_blocks)
        pieces.room_for(name_cost).removed_blocks.push_back(key);
    for (const BoxId id : change.removed_boxes) pieces.room_for(id_cost).removed_boxes.push_back(id);
    return pieces.finish(header.state_hash);
}

}  // namespace trochoid
