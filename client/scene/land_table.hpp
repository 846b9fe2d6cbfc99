#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "protocol/model/interest_state.hpp"
#include "protocol/units/lattice.hpp"

namespace trochoid {

/// Texels (RGBA32I) of a field's row behind the trains' rows.
inline constexpr int field_row_texels = 2;

/// The land fields of a state as the shaders want them: for each field a window of slots over its blocks, each slot the first
/// node of a block or -1; nodes as (shift, gain) pairs.
class LandTable {
public:
    /// Takes over the blocks of a state. False where they are the very same ones as before: then nothing has changed.
    /// Fields whose window would exceed `slot_limit` slots are left out and counted.
    bool rebuild(const InterestState& state, size_t slot_limit, size_t node_limit);

    /// Row of a field, or -1 (such a train reads shift 0 and gain 1).
    int row_of(FieldId id) const;
    size_t field_count() const { return fields_.size(); }
    size_t block_count() const { return nodes_.size() / (block_nodes * block_nodes); }
    /// Blocks that found no room in the limits.
    size_t left_out() const { return left_out_; }

    const std::vector<int32_t>& slots() const { return slots_; }
    const std::vector<std::array<int32_t, 2>>& nodes() const { return nodes_; }
    /// The rows of all fields relative to an anchor.
    void append_fields(std::vector<std::array<int32_t, 4>>& out, LatticePoint anchor) const;

private:
    struct Field {
        FieldId id;
        int step_log2 = 16;
        BlockKey first;
        int64_t columns = 0;
        int64_t rows = 0;
        size_t first_slot = 0;
    };
    using Blocks = std::map<FieldBlockKey, FieldBlock>;
    void add_field(Blocks::const_iterator first, Blocks::const_iterator last, size_t slot_limit,
                   size_t node_limit);

    std::vector<Field> fields_;  // ascending id
    std::vector<int32_t> slots_;
    std::vector<std::array<int32_t, 2>> nodes_;
    std::vector<std::shared_ptr<const LandBlock>> seen_;
    size_t left_out_ = 0;
};

}  // namespace trochoid
