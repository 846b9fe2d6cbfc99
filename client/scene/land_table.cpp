#include "client/scene/land_table.hpp"

#include <algorithm>
#include <bit>

namespace trochoid {

namespace {

bool same_blocks(const InterestState& state, const std::vector<std::shared_ptr<const LandBlock>>& seen) {
    if (state.blocks.size() != seen.size()) return false;
    return std::equal(seen.begin(), seen.end(), state.blocks.begin(),
                      [](const auto& known, const auto& entry) { return known == entry.second.block; });
}

int32_t clamped(int64_t v) {
    return static_cast<int32_t>(std::clamp<int64_t>(v, INT32_MIN / 2, INT32_MAX / 2));
}

}  // namespace

void LandTable::add_field(Blocks::const_iterator first, Blocks::const_iterator last, size_t slot_limit,
                          size_t node_limit) {
    BlockKey low = first->first.block;
    BlockKey high = low;
    size_t blocks = 0;
    for (auto at = first; at != last; ++at, ++blocks) {
        const BlockKey key = at->first.block;
        low = {std::min(low.x, key.x), std::min(low.z, key.z)};
        high = {std::max(high.x, key.x), std::max(high.z, key.z)};
    }
    const int64_t columns = int64_t{high.x} - low.x + 1;
    const int64_t rows = int64_t{high.z} - low.z + 1;
    const bool fits = columns <= int64_t{1} << 24 && rows <= int64_t{1} << 24 &&
                      slots_.size() + static_cast<uint64_t>(columns * rows) <= slot_limit &&
                      nodes_.size() + blocks * block_nodes * block_nodes <= node_limit;
    if (!fits) {
        left_out_ += blocks;
        return;
    }
    const Field field{first->first.field, first->second.step_log2, low, columns, rows, slots_.size()};
    slots_.resize(slots_.size() + static_cast<size_t>(columns * rows), -1);
    for (auto at = first; at != last; ++at) {
        const LandBlock& block = *at->second.block;
        const int64_t slot = (int64_t{block.key.z} - low.z) * columns + (int64_t{block.key.x} - low.x);
        slots_[field.first_slot + static_cast<size_t>(slot)] = static_cast<int32_t>(nodes_.size());
        for (size_t i = 0; i < block.shift.size(); ++i) nodes_.push_back({block.shift[i], block.gain[i]});
    }
    fields_.push_back(field);
}

bool LandTable::rebuild(const InterestState& state, size_t slot_limit, size_t node_limit) {
    if (same_blocks(state, seen_)) return false;
    *this = LandTable{};
    for (const auto& [key, entry] : state.blocks) seen_.push_back(entry.block);
    for (auto at = state.blocks.begin(); at != state.blocks.end();) {
        const FieldId id = at->first.field;
        const auto last =
            std::find_if(at, state.blocks.end(), [id](const auto& entry) { return entry.first.field != id; });
        add_field(at, last, slot_limit, node_limit);
        at = last;
    }
    return true;
}

int LandTable::row_of(FieldId id) const {
    if (id.value == 0) return -1;
    const auto at = std::lower_bound(fields_.begin(), fields_.end(), id,
                                     [](const Field& f, FieldId wanted) { return f.id < wanted; });
    return at == fields_.end() || at->id != id ? -1 : static_cast<int>(at - fields_.begin());
}

/// A field as two texels: anchor's node relative to the window's first (x, z), log2 of the step, first slot;
/// columns and rows of slots, radians per unit of shift slope and per metre, gain per unit of gain slope and per metre.
void LandTable::append_fields(std::vector<std::array<int32_t, 4>>& out, LatticePoint anchor) const {
    for (const Field& field : fields_) {
        const int64_t node_x = (anchor.x >> field.step_log2) - int64_t{field.first.x} * block_cells;
        const int64_t node_z = (anchor.z >> field.step_log2) - int64_t{field.first.z} * block_cells;
        // As in LandField::sample.
        const float metres = static_cast<float>(int32_t{1} << (field.step_log2 - 10));
        const float radians_per_step = 0x1.921fb6p-14F / metres;
        const float gain_per_step = 0x1p-23F / metres;
        out.push_back(
            {clamped(node_x), clamped(node_z), field.step_log2, static_cast<int32_t>(field.first_slot)});
        out.push_back({static_cast<int32_t>(field.columns), static_cast<int32_t>(field.rows),
                       std::bit_cast<int32_t>(radians_per_step), std::bit_cast<int32_t>(gain_per_step)});
    }
}

}  // namespace trochoid
