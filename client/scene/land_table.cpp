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

/// Every field alone, and every chain that a train of a box reads.
std::map<FieldChain, int> chains_of(const InterestState& state) {
    std::map<FieldChain, int> chains;
    FieldId last;
    for (const auto& [key, block] : state.blocks) {
        if (key.field != last) chains[FieldChain{key.field}] = -1;
        last = key.field;
    }
    for (const auto& [id, record] : state.boxes) {
        if (record->overlays.empty()) continue;
        last = {};
        for (const WaveTrain& train : record->trains) {
            if (train.field != last && train.field.value != 0) chains[chain_of(*record, train.field)] = -1;
            last = train.field;
        }
    }
    return chains;
}

bool same_chains(const std::map<FieldChain, int>& a, const std::map<FieldChain, int>& b) {
    return a.size() == b.size() &&
           std::equal(a.begin(), a.end(), b.begin(),
                      [](const auto& x, const auto& y) { return x.first == y.first; });
}

}  // namespace

FieldChain chain_of(const WaveTrainBox& record, FieldId field) {
    FieldChain chain{field};
    for (;;) {
        const auto over =
            std::find_if(record.overlays.begin(), record.overlays.end(),
                         [&](const FieldOverlay& o) { return o.field == chain.back() && o.base < o.field; });
        if (over == record.overlays.end()) return chain;
        chain.push_back(over->base);
    }
}

LandTable::Layered LandTable::lay_over(const InterestState& state, const FieldChain& chain) {
    Layered out;
    bool known = false;
    for (const FieldId id : chain) {
        auto at = state.blocks.lower_bound({id, {INT32_MIN, INT32_MIN}});
        if (at == state.blocks.end() || at->first.field != id) continue;
        // A base of another step does not count, nor what lies below it (prepare, sea.cpp).
        if (known && at->second.step_log2 != out.step_log2) break;
        out.step_log2 = at->second.step_log2;
        known = true;
        for (; at != state.blocks.end() && at->first.field == id; ++at)
            out.blocks.try_emplace(at->first.block, at->second.block);
    }
    return out;
}

int32_t LandTable::nodes_of(const std::shared_ptr<const LandBlock>& block) {
    const auto [at, added] = first_node_.try_emplace(block.get(), static_cast<int32_t>(nodes_.size()));
    if (!added) return at->second;
    for (size_t i = 0; i < block->shift.size(); ++i) {
        const uint32_t pair = uint32_t{block->gain[i]} | uint32_t{block->orbit[i]} << 16;
        nodes_.push_back({block->shift[i], std::bit_cast<int32_t>(pair)});
        largest_orbit_ = std::max(largest_orbit_, block->orbit[i]);
    }
    return at->second;
}

void LandTable::add_field(const FieldChain& chain, const Layered& layered, Limits limits) {
    if (layered.blocks.empty()) return;
    BlockKey low = layered.blocks.begin()->first;
    BlockKey high = low;
    size_t unseen = 0;
    for (const auto& [key, block] : layered.blocks) {
        low = {std::min(low.x, key.x), std::min(low.z, key.z)};
        high = {std::max(high.x, key.x), std::max(high.z, key.z)};
        unseen += first_node_.contains(block.get()) ? 0U : 1U;
    }
    const int64_t columns = int64_t{high.x} - low.x + 1;
    const int64_t rows = int64_t{high.z} - low.z + 1;
    const bool fits = columns <= int64_t{1} << 24 && rows <= int64_t{1} << 24 &&
                      slots_.size() + static_cast<uint64_t>(columns * rows) <= limits.slots &&
                      nodes_.size() + unseen * block_nodes * block_nodes <= limits.nodes;
    if (!fits) {
        left_out_ += unseen;
        return;
    }
    const Field field{layered.step_log2, low, columns, rows, slots_.size()};
    slots_.resize(slots_.size() + static_cast<size_t>(columns * rows), -1);
    for (const auto& [key, block] : layered.blocks) {
        const int64_t slot = (int64_t{key.z} - low.z) * columns + (int64_t{key.x} - low.x);
        slots_[field.first_slot + static_cast<size_t>(slot)] = nodes_of(block);
    }
    rows_[chain] = static_cast<int>(fields_.size());
    fields_.push_back(field);
}

bool LandTable::rebuild(const InterestState& state, size_t slot_limit, size_t node_limit) {
    std::map<FieldChain, int> chains = chains_of(state);
    if (same_blocks(state, seen_) && same_chains(chains, rows_)) return false;
    *this = LandTable{};
    for (const auto& [key, entry] : state.blocks) seen_.push_back(entry.block);
    rows_ = chains;
    for (const auto& [chain, row] : chains)
        add_field(chain, lay_over(state, chain), {slot_limit, node_limit});
    return true;
}

int LandTable::row_of_chain(const FieldChain& chain) const {
    const auto at = rows_.find(chain);
    return at == rows_.end() ? -1 : at->second;
}

/// A field as two texels: anchor's node relative to the window's first (x, z), log2 of the step, first slot;
/// columns and rows of slots, radians per unit of shift slope and per metre, gain per unit of gain slope and per metre.
void LandTable::append_fields(std::vector<std::array<int32_t, 4>>& out, LatticePoint anchor) const {
    for (const Field& field : fields_) {
        const int64_t node_x = (anchor.x >> field.step_log2) - int64_t{field.first.x} * block_cells;
        const int64_t node_z = (anchor.z >> field.step_log2) - int64_t{field.first.z} * block_cells;
        // As in LandField::sample; orbits take twice the gain's, exactly.
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
