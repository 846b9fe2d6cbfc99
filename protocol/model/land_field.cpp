#include "protocol/model/land_field.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

constexpr int32_t largest_shift = 1 << 30;
constexpr int32_t largest_shift_step = 1 << 23;

/// Windows larger than this would be a peer's attempt to make us allocate: 2^22 slots of 16 bytes.
constexpr int64_t largest_window = int64_t{1} << 22;

size_t node(int x, int z) { return static_cast<size_t>(z * block_nodes + x); }

}  // namespace

bool trivial(const LandBlock& block) {
    return std::all_of(block.shift.begin(), block.shift.end(), [](int32_t s) { return s == 0; }) &&
           std::all_of(block.gain.begin(), block.gain.end(),
                       [](uint16_t g) { return g == unit_node_gain; }) &&
           std::all_of(block.orbit.begin(), block.orbit.end(),
                       [](uint16_t o) { return o == unit_node_orbit; });
}

Result<Done> validate(const LandBlock& block) {
    for (const int32_t s : block.shift)
        if (s >= largest_shift || s <= -largest_shift)
            return Error{ErrorCode::value_out_of_range, "a land block's phase shift is not below 2^30"};
    for (int z = 0; z < block_nodes; ++z)
        for (int x = 0; x < block_nodes; ++x) {
            const int64_t here = block.shift[node(x, z)];
            const int64_t east = x + 1 < block_nodes ? block.shift[node(x + 1, z)] : here;
            const int64_t south = z + 1 < block_nodes ? block.shift[node(x, z + 1)] : here;
            if (std::max(std::abs(east - here), std::abs(south - here)) >= largest_shift_step)
                return Error{ErrorCode::value_out_of_range,
                             "a land block's phase shift steps by 128 turns or more in a cell"};
        }
    return Done{};
}

LandField::LandField(FieldId id, uint8_t step_log2) : id_(id), step_log2_(step_log2) {
    TROCHOID_ASSERT(step_log2 >= 12 && step_log2 <= 20, "step_log2 {}", step_log2);
}

size_t LandField::slot_of(BlockKey key) const {
    return static_cast<size_t>(key.z - first_.z) * static_cast<size_t>(columns_) +
           static_cast<size_t>(key.x - first_.x);
}

LandField::Window LandField::window_with(BlockKey key) const {
    if (columns_ == 0) return {key, 1, 1};
    const BlockKey first{std::min(first_.x, key.x), std::min(first_.z, key.z)};
    const int64_t last_x = std::max(int64_t{first_.x} + columns_ - 1, int64_t{key.x});
    const int64_t last_z = std::max(int64_t{first_.z} + rows_ - 1, int64_t{key.z});
    return {first, last_x - first.x + 1, last_z - first.z + 1};
}

bool LandField::fits(BlockKey key) const {
    const Window w = window_with(key);
    return w.columns <= largest_window && w.rows <= largest_window && w.columns * w.rows <= largest_window;
}

void LandField::grow_to(const Window& w) {
    TROCHOID_ASSERT(w.columns * w.rows <= largest_window, "land field window {} x {} blocks", w.columns,
                    w.rows);
    auto slots = std::make_shared<Slots>(static_cast<size_t>(w.columns * w.rows));
    if (slots_)
        for (const auto& old : *slots_)
            if (old)
                (*slots)[static_cast<size_t>((int64_t{old->key.z} - w.first.z) * w.columns +
                                             (int64_t{old->key.x} - w.first.x))] = old;
    slots_ = std::move(slots);
    first_ = w.first;
    columns_ = static_cast<int32_t>(w.columns);
    rows_ = static_cast<int32_t>(w.rows);
}

void LandField::make_room(BlockKey first, BlockKey last) {
    for (const BlockKey& key : {first, last}) {
        const Window w = window_with(key);
        if (w.first != first_ || w.columns != columns_ || w.rows != rows_) grow_to(w);
    }
}

void LandField::set(std::shared_ptr<const LandBlock> block) {
    const BlockKey key = block->key;
    make_room(key, key);
    if (slots_.use_count() > 1) slots_ = std::make_shared<Slots>(*slots_);
    auto& slot = (*slots_)[slot_of(key)];
    if (!slot) ++count_;
    slot = std::move(block);
}

void LandField::set_base(std::shared_ptr<const LandField> base) {
    TROCHOID_ASSERT(!base || (base->step_log2_ == step_log2_ && base->id_ < id_),
                    "field {} over field {} of another step or a later id", id_.value,
                    base ? base->id_.value : 0);
    base_ = std::move(base);
}

const std::shared_ptr<const LandBlock>* LandField::own_slot(BlockKey key) const {
    if (key.x < first_.x || key.z < first_.z || int64_t{key.x} - first_.x >= columns_ ||
        int64_t{key.z} - first_.z >= rows_)
        return nullptr;
    const auto& slot = (*slots_)[slot_of(key)];
    return slot ? &slot : nullptr;
}

const LandBlock* LandField::find(BlockKey key) const {
    for (const LandField* field = this; field != nullptr; field = field->base_.get())
        if (const auto* slot = field->own_slot(key)) return slot->get();
    return nullptr;
}

std::shared_ptr<const LandBlock> LandField::share(BlockKey key) const {
    for (const LandField* field = this; field != nullptr; field = field->base_.get())
        if (const auto* slot = field->own_slot(key)) return *slot;
    return nullptr;
}

std::vector<std::shared_ptr<const LandBlock>> LandField::blocks() const {
    std::vector<std::shared_ptr<const LandBlock>> all;
    all.reserve(count_);
    if (!slots_) return all;
    for (const auto& slot : *slots_)
        if (slot) all.push_back(slot);
    return all;
}

LandSample LandField::sample(LatticePoint p) const {
    LandSample out;
    const int64_t nx = p.x >> step_log2_;
    const int64_t nz = p.z >> step_log2_;
    const LandBlock* block = find({static_cast<int32_t>(nx >> 4), static_cast<int32_t>(nz >> 4)});
    if (block == nullptr) return out;
    // Position in the cell, Q0.16.
    const int64_t mask = (int64_t{1} << step_log2_) - 1;
    const auto fx = static_cast<int64_t>(((p.x & mask) << 16) >> step_log2_);
    const auto fz = static_cast<int64_t>(((p.z & mask) << 16) >> step_log2_);
    const size_t n00 = node(static_cast<int>(nx & 15), static_cast<int>(nz & 15));
    const size_t n10 = n00 + 1;
    const size_t n01 = n00 + block_nodes;
    const size_t n11 = n01 + 1;

    const int64_t p00 = block->shift[n00];
    const int64_t p10 = block->shift[n10];
    const int64_t p01 = block->shift[n01];
    const int64_t p11 = block->shift[n11];
    const int64_t cross = (p11 - p01) - (p10 - p00);
    const int64_t slope_x = (p10 - p00) + ((cross * fz) >> 16);
    const int64_t slope_z = (p01 - p00) + ((cross * fx) >> 16);
    out.shift = static_cast<uint32_t>(static_cast<uint64_t>((p00 * 65536) + (p01 - p00) * fz + slope_x * fx));
    const float metres = static_cast<float>(int32_t{1} << (step_log2_ - 10));
    const float radians_per_step = 0x1.921fb6p-14F / metres;  // 2*pi * 2^-16 turn, per metre
    out.dshift_dx = static_cast<float>(static_cast<int32_t>(slope_x)) * radians_per_step;
    out.dshift_dz = static_cast<float>(static_cast<int32_t>(slope_z)) * radians_per_step;

    const int64_t g00 = block->gain[n00];
    const int64_t g10 = block->gain[n10];
    const int64_t g01 = block->gain[n01];
    const int64_t g11 = block->gain[n11];
    // Edges of the cell at this point, Q1.23.
    const int64_t west = (g00 * (65536 - fz) + g01 * fz) >> 8;
    const int64_t east = (g10 * (65536 - fz) + g11 * fz) >> 8;
    const int64_t north = (g00 * (65536 - fx) + g10 * fx) >> 8;
    const int64_t south = (g01 * (65536 - fx) + g11 * fx) >> 8;
    out.gain = static_cast<uint32_t>(west + (((east - west) * fx) >> 16)) << 1;
    const float gain_per_step = 0x1p-23F / metres;
    out.dgain_dx = static_cast<float>(static_cast<int32_t>(east - west)) * gain_per_step;
    out.dgain_dz = static_cast<float>(static_cast<int32_t>(south - north)) * gain_per_step;

    const int64_t o00 = block->orbit[n00];
    const int64_t o10 = block->orbit[n10];
    const int64_t o01 = block->orbit[n01];
    const int64_t o11 = block->orbit[n11];
    // The same, Q2.22: at most 24 bits, so every conversion is exact.
    const int64_t orbit_west = (o00 * (65536 - fz) + o01 * fz) >> 8;
    const int64_t orbit_east = (o10 * (65536 - fz) + o11 * fz) >> 8;
    const int64_t orbit_north = (o00 * (65536 - fx) + o10 * fx) >> 8;
    const int64_t orbit_south = (o01 * (65536 - fx) + o11 * fx) >> 8;
    const int64_t orbit = orbit_west + (((orbit_east - orbit_west) * fx) >> 16);
    out.orbit = static_cast<float>(static_cast<int32_t>(orbit)) * 0x1p-22F;
    const float orbit_per_step = 0x1p-22F / metres;
    out.dorbit_dx = static_cast<float>(static_cast<int32_t>(orbit_east - orbit_west)) * orbit_per_step;
    out.dorbit_dz = static_cast<float>(static_cast<int32_t>(orbit_south - orbit_north)) * orbit_per_step;
    return out;
}

BlockRange blocks_touching(const LatticeRect& rect, uint8_t step_log2) {
    const int shift = step_log2 + 4;
    const auto block = [shift](int64_t v) { return static_cast<int32_t>(v >> shift); };
    return {{block(rect.min.x), block(rect.min.z)}, {block(rect.max.x), block(rect.max.z)}};
}

}  // namespace trochoid
