#include "protocol/model/simd/scratch.hpp"

namespace trochoid::simd {

namespace {

uint32_t pair(uint16_t west, uint16_t east) { return uint32_t{west} | (uint32_t{east} << 16); }

void load_cell(const PlannedField& field, int32_t nx, int32_t nz, SpanCells& c, size_t i) {
    const LandBlock* block = field.find({nx >> 4, nz >> 4});
    if (block == nullptr) {
        c.p00[i] = c.p10[i] = c.p01[i] = c.p11[i] = 0;
        c.gain0[i] = c.gain1[i] = pair(unit_node_gain, unit_node_gain);
        c.orbit0[i] = c.orbit1[i] = pair(unit_node_orbit, unit_node_orbit);
        return;
    }
    const auto north = static_cast<size_t>((nz & 15) * block_nodes + (nx & 15));
    const size_t south = north + block_nodes;
    c.p00[i] = block->shift[north];
    c.p10[i] = block->shift[north + 1];
    c.p01[i] = block->shift[south];
    c.p11[i] = block->shift[south + 1];
    c.gain0[i] = pair(block->gain[north], block->gain[north + 1]);
    c.gain1[i] = pair(block->gain[south], block->gain[south + 1]);
    c.orbit0[i] = pair(block->orbit[north], block->orbit[north + 1]);
    c.orbit1[i] = pair(block->orbit[south], block->orbit[south + 1]);
}

void copy_cell(SpanCells& c, size_t i) {
    const size_t from = i - 1;
    c.p00[i] = c.p00[from];
    c.p10[i] = c.p10[from];
    c.p01[i] = c.p01[from];
    c.p11[i] = c.p11[from];
    c.gain0[i] = c.gain0[from];
    c.gain1[i] = c.gain1[from];
    c.orbit0[i] = c.orbit0[from];
    c.orbit1[i] = c.orbit1[from];
}

}  // namespace

void load_cells(const PlannedField& field, const SpanPlaces& at, SpanCells& c) {
    if (c.version == at.version) return;
    const auto refresh = [&](size_t i) {
        // Along a row most points share their neighbour's cell, which is up to date by now.
        if (i != 0 && at.column[i] == at.column[i - 1] && at.row[i] == at.row[i - 1])
            copy_cell(c, i);
        else
            load_cell(field, at.column[i], at.row[i], c, i);
    };
    if (c.version != 0 && c.version + 1 == at.version)
        for (size_t k = 0; k < static_cast<size_t>(at.changes); ++k) refresh(at.changed[k]);
    else
        for (size_t i = 0; i < at.count; ++i) refresh(i);
    c.version = at.version;
}

}  // namespace trochoid::simd
