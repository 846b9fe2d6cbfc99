#include <bit>
#include <cstring>

#include "protocol/model/simd/scratch.hpp"

namespace trochoid::simd {

namespace {

/// A node and its neighbour in the east, in one load: west in the low half.
uint32_t pair_at(const uint16_t* west) {
    uint32_t both = 0;
    std::memcpy(&both, west, sizeof both);
    return std::endian::native == std::endian::big ? std::rotl(both, 16) : both;
}

void load_cell(const LandBlock& block, size_t north, SpanCells& c, size_t i) {
    const size_t south = north + block_nodes;
    std::memcpy(&c.shift0[2 * i], &block.shift[north], 2 * sizeof(int32_t));
    std::memcpy(&c.shift1[2 * i], &block.shift[south], 2 * sizeof(int32_t));
    c.gain0[i] = pair_at(&block.gain[north]);
    c.gain1[i] = pair_at(&block.gain[south]);
    c.orbit0[i] = pair_at(&block.orbit[north]);
    c.orbit1[i] = pair_at(&block.orbit[south]);
}

/// Calls look(i) for each point whose cell is not the one that was looked up last.
template <class Look>
void each_new_cell(const SpanPlaces& at, const SpanCells& c, Look look) {
    if (c.version != 0 && c.version + 1 == at.version)
        for (size_t k = 0; k < static_cast<size_t>(at.changes); ++k) look(at.changed[k]);
    else
        for (size_t i = 0; i < at.count; ++i) look(i);
}

}  // namespace

void load_cells(const PlannedField& field, const SpanPlaces& at, SpanCells& c) {
    if (c.version == at.version) return;
    if (const LandBlock* const* blocks = field.blocks.data(); !field.blocks.empty())
        each_new_cell(at, c, [&](size_t i) { load_cell(*blocks[at.block[i]], at.node[i], c, i); });
    else
        each_new_cell(at, c, [&](size_t i) {
            const LandBlock* block = field.field->find({at.column[i] >> 4, at.row[i] >> 4});
            load_cell(block != nullptr ? *block : open_block(), at.node[i], c, i);
        });
    c.version = at.version;
}

}  // namespace trochoid::simd
