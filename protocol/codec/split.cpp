#include <algorithm>
#include <variant>

#include "protocol/codec/codec.hpp"
#include "protocol/codec/patch_coding.hpp"
#include "protocol/codec/plane_coding.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

/// At least and at most what an entry adds to an encoding, in bytes. Lists of structs cost exactly their elements; tables cost
/// their members, a vtable that is shared at best, and padding. The tests hold them against real encodings.
struct Cost {
    size_t least = 0;
    size_t most = 0;
    size_t boxes = 0;  ///< of a patch: a message has most_patch_boxes of them at the most
};
constexpr size_t lists_cost = 11 * 24;  // eleven lists: place in the table, vtable slot, length, padding
constexpr size_t box_cost = 104 + 24 + 24 + 32;
constexpr size_t extras_cost = 24 + 8 + 8 + 16 + 36 + 16 + 20 + 12 + 8;  // members, lengths, structs, padding
constexpr size_t train_cost = 28;
constexpr size_t field_cost = 5;  // an entry of fields and one of field_of_train
constexpr size_t overlay_cost = 8;
constexpr size_t leg_cost = 40;
constexpr size_t block_cost = 16;
constexpr size_t patch_cost = 20;
constexpr size_t patch_box_cost = 4;
constexpr size_t name_cost = 12;
constexpr size_t id_cost = 4;
// In planes: level, x and z at most 2 + 4 + 4, a bound 5. Where a column of counts begins and ends an entry are two residuals of
// 2 bytes and two runs of 3; its first adds a run and an id.
constexpr size_t planes_key_cost = 10;
constexpr size_t planes_bound_cost = 5;
constexpr size_t planes_box_cost = 2 * (2 + 3) + 3 + id_cost;

bool plain(const WaveTrainBox& box) {
    return box.raised_us == 0 && box.fade_us == 0 && box.overlays.empty() && box.course.empty() &&
           box.irregular == IrregularHeight{} && box.noise == SurfaceNoise{} && box.wake == ShipWake{} &&
           box.hull == Hull{};
}

Cost cost_of(const WaveTrainBox& box, PatchForm) {
    const size_t lists = box.overlays.size() * overlay_cost + box.course.size() * leg_cost;
    return {104 + box.trains.size() * train_cost + lists,
            box_cost + box.trains.size() * (train_cost + field_cost) + (plain(box) ? 0 : extras_cost) + lists,
            0};
}
Cost cost_of(const FieldBlock& block, PatchForm) {
    const size_t exactly = block_cost + code_nodes(*block.block).size();
    return {exactly, exactly, 0};
}
Cost cost_of(const PatchDescriptor& patch, PatchForm form) {
    const size_t boxes = patch.boxes.size();
    if (form == PatchForm::planes)
        return {1, planes_key_cost + 2 * planes_bound_cost + boxes * planes_box_cost, boxes};
    return {patch_cost + boxes * patch_box_cost, patch_cost + boxes * (patch_box_cost + id_cost), boxes};
}
Cost cost_of(const PatchKey&, PatchForm form) {
    return form == PatchForm::planes ? Cost{1, planes_key_cost, 0} : Cost{name_cost, name_cost, 0};
}
Cost cost_of(const FieldBlockKey&, PatchForm) { return {name_cost, name_cost, 0}; }
Cost cost_of(const BoxId&, PatchForm) { return {id_cost, id_cost, 0}; }

void add(InterestDelta& to, const std::shared_ptr<const WaveTrainBox>& box) { to.boxes.push_back(box); }
void add(InterestDelta& to, const FieldBlock& block) { to.blocks.push_back(block); }
void add(InterestDelta& to, const PatchDescriptor& patch) { to.patches.push_back(patch); }
void add(InterestDelta& to, const PatchKey& key) { to.removed_patches.push_back(key); }
void add(InterestDelta& to, const FieldBlockKey& key) { to.removed_blocks.push_back(key); }
void add(InterestDelta& to, const BoxId& id) { to.removed_boxes.push_back(id); }

/// What a change is made of, in the order in which it travels.
class Entries {
public:
    Entries(const Delta& header, size_t max_bytes) : blank_(header), limit_(max_bytes) {
        blank_.change = {};
        blank_.last = false;
        blank_.state_hash = 0;
        fixed_ = encode(ServerMessage(blank_)).size();
    }

    void add(const std::shared_ptr<const WaveTrainBox>& box) {
        entries_.push_back({&box, cost_of(*box, blank_.patch_form)});
    }
    template <class Part>
    void add(const Part& part) {
        entries_.push_back({&part, cost_of(part, blank_.patch_form)});
    }

    std::vector<Delta> in_pieces(uint64_t state_hash) {
        std::vector<Delta> pieces;
        size_t done = 0;
        do {
            TROCHOID_ASSERT(pieces.size() <= UINT16_MAX, "{} pieces", pieces.size());
            blank_.piece = static_cast<uint16_t>(pieces.size());
            const size_t count = how_many_fit(done);
            pieces.push_back(piece(done, count));
            done += count;
        } while (done < entries_.size());
        pieces.back().last = true;
        pieces.back().state_hash = state_hash;
        return pieces;
    }

private:
    struct Entry {
        std::variant<const std::shared_ptr<const WaveTrainBox>*, const FieldBlock*, const PatchDescriptor*,
                     const PatchKey*, const FieldBlockKey*, const BoxId*>
            part;
        Cost cost;
    };

    Delta piece(size_t first, size_t count) const {
        Delta piece = blank_;
        for (size_t i = first; i < first + count; ++i)
            std::visit([&](const auto* part) { trochoid::add(piece.change, *part); }, entries_[i].part);
        if (blank_.patch_form == PatchForm::planes) {
            std::sort(piece.change.patches.begin(), piece.change.patches.end(),
                      [](const PatchDescriptor& a, const PatchDescriptor& b) { return a.key < b.key; });
            std::sort(piece.change.removed_patches.begin(), piece.change.removed_patches.end());
        }
        return piece;
    }

    bool fits(size_t first, size_t count) const {
        return encode(ServerMessage(piece(first, count))).size() <= limit_;
    }

    /// The bounds of the costs tell most of it; what they leave open is tried, all first.
    size_t how_many_fit(size_t first) const {
        size_t surely = 0;
        size_t maybe = 0;
        Cost sum{fixed_, fixed_ + lists_cost, 0};
        for (size_t i = first; i < entries_.size(); ++i) {
            sum.least += entries_[i].cost.least;
            sum.most += entries_[i].cost.most;
            sum.boxes += entries_[i].cost.boxes;
            if (sum.least > limit_ || sum.boxes > most_patch_boxes) break;
            ++maybe;
            if (sum.most <= limit_) ++surely;
        }
        if (maybe > surely && fits(first, maybe)) surely = maybe;
        while (surely + 1 < maybe) {
            const size_t middle = surely + (maybe - surely) / 2;
            (fits(first, middle) ? surely : maybe) = middle;
        }
        TROCHOID_ASSERT(surely > 0 || first == entries_.size(),
                        "an entry of {} bytes and the key's {} do not fit a message of {}",
                        entries_[first].cost.most, fixed_, limit_);
        return surely;
    }

    Delta blank_;
    size_t limit_;
    size_t fixed_ = 0;
    std::vector<Entry> entries_;
};

LatticeRect rect_of_block(const FieldBlock& block) {
    const int64_t side = int64_t{block_cells} << block.step_log2;
    const LatticePoint min{block.block->key.x * side, block.block->key.z * side};
    return {min, {min.x + side, min.z + side}};
}

/// Every patch right after the blocks under it that have not travelled yet; then the blocks under no patch.
void add_patches_with_blocks(Entries& entries, const InterestDelta& change) {
    std::vector<const FieldBlock*> waiting;
    waiting.reserve(change.blocks.size());
    for (const FieldBlock& block : change.blocks) waiting.push_back(&block);
    for (const PatchDescriptor& patch : change.patches) {
        const LatticeRect place = rect_of(patch.key);
        size_t kept = 0;
        for (const FieldBlock* block : waiting)
            if (overlap(rect_of_block(*block), place))
                entries.add(*block);
            else
                waiting[kept++] = block;
        waiting.resize(kept);
        entries.add(patch);
    }
    for (const FieldBlock* block : waiting) entries.add(*block);
}

}  // namespace

std::vector<Delta> split(const Delta& header, const InterestDelta& change, size_t max_bytes) {
    Entries entries(header, max_bytes);
    for (const auto& box : change.boxes) entries.add(box);
    add_patches_with_blocks(entries, change);
    for (const PatchKey& key : change.removed_patches) entries.add(key);
    for (const FieldBlockKey& key : change.removed_blocks) entries.add(key);
    for (const BoxId& id : change.removed_boxes) entries.add(id);
    return entries.in_pieces(header.state_hash);
}

}  // namespace trochoid
