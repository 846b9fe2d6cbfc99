#include "tests/golden/edge_fields.hpp"

#include <fmt/format.h>

#include <ostream>
#include <utility>

#include "protocol/units/hash.hpp"
#include "tests/golden/golden_text.hpp"

namespace trochoid {

namespace {

/// A block whose nodes are drawn: neighbours' shifts differ by up to `steep` (2^-16 turn), gains and orbits over all their range.
std::shared_ptr<LandBlock> drawn_block(BlockKey key, uint64_t seed, int32_t middle, int32_t steep) {
    auto block = std::make_shared<LandBlock>();
    block->key = key;
    for (size_t i = 0; i < block->shift.size(); ++i) {
        const uint64_t dice = splitmix64(seed * 1000 + i);
        block->shift[i] = middle + static_cast<int32_t>(dice % static_cast<uint64_t>(steep)) - steep / 2;
        block->gain[i] = static_cast<uint16_t>(dice >> 32);
        block->orbit[i] = static_cast<uint16_t>(dice >> 48);
    }
    // The ends of the ranges side by side.
    block->gain[0] = block->orbit[1] = block->gain[20] = 0;
    block->gain[1] = block->orbit[0] = block->orbit[18] = UINT16_MAX;
    return block;
}

std::shared_ptr<LandField> field_of(uint32_t id, uint8_t step_log2,
                                    std::vector<std::shared_ptr<LandBlock>> blocks) {
    auto field = std::make_shared<LandField>(FieldId{id}, step_log2);
    for (auto& block : blocks) field->set(std::move(block));
    return field;
}

void write_lines(std::ostream& out, const LandField& field, uint32_t base) {
    const int64_t step = int64_t{1} << field.step_log2();
    const int64_t side = step * block_cells;
    const auto line = [&](LatticePoint p) {
        out << fmt::format("land {} {} {} {} {}\n", field.id().value, base, p.x, p.z, land_text(field, p));
    };
    // Nodes, edges and corners of cells and blocks, then anywhere on and beside the blocks.
    for (const LatticePoint p : {LatticePoint{0, 0},
                                 {1, 1},
                                 {step - 1, step - 1},
                                 {step, 0},
                                 {0, step},
                                 {-1, -1},
                                 {side - 1, side / 2},
                                 {side, 5},
                                 {-side, -side},
                                 {-side - 1, 0},
                                 {5, -side + 1}})
        line(p);
    for (uint64_t i = 0; i < 20; ++i) {
        const uint64_t dice = splitmix64(7000 + i + 100 * field.id().value);
        const uint64_t span = static_cast<uint64_t>(side) * 2 + 1;
        line({static_cast<int64_t>(dice % span) - side, static_cast<int64_t>((dice >> 30) % span) - side});
    }
}

}  // namespace

std::vector<std::shared_ptr<const LandField>> edge_fields() {
    constexpr int32_t steepest = (1 << 23) - 1;
    constexpr int32_t highest = (1 << 30) - (1 << 23);
    return {field_of(1, 12, {drawn_block({0, 0}, 1, 0, 5000), drawn_block({-1, 0}, 2, -90'000, 70'000)}),
            field_of(2, 12, {drawn_block({0, 0}, 3, highest, steepest)}),
            field_of(3, 12, {drawn_block({0, -1}, 4, -highest, 1'000'000)}),
            field_of(4, 20, {drawn_block({-1, -1}, 5, 1234, 800'000)}),
            field_of(5, 13, {drawn_block({0, -1}, 6, 0, 30'000)})};
}

void write_fields(std::ostream& out) {
    out << R"(# Trochoid golden vectors, model version 2: land fields. Floats: 8 hex digits of their IEEE 754 binary32 bits; all else decimal integers.
# field ID STEP_LOG2
# block X Z then 289 shifts, 289 gains and 289 orbits      of the last field
# land FIELD BASE X Z SHIFT DX DZ GAIN DX DZ ORBIT DX DZ   at a point, each with its slopes; BASE: the field under it, 0 none (chapter 2.6)
)";
    const auto fields = edge_fields();
    for (const auto& field : fields) write_field(out, *field);
    for (const auto& field : fields) write_lines(out, *field, 0);
    for (const size_t top : {size_t{1}, size_t{2}}) {
        LandField over(*fields[top]);
        over.set_base(fields[top - 1]);
        write_lines(out, over, fields[top - 1]->id().value);
    }
}

}  // namespace trochoid
