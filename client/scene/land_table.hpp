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

/// A field and what it lies over, uppermost first (WaveTrainBox::overlays).
using FieldChain = std::vector<FieldId>;
FieldChain chain_of(const WaveTrainBox& record, FieldId field);

/// The land fields of a state as the shaders want them: for each field a window of slots over its blocks, each slot the first
/// node of a block or -1; nodes as (shift, gain and orbit) pairs. Overlays are laid over their bases here: a chain of fields
/// has one window, in which the uppermost block counts; blocks that several windows hold share their nodes.
class LandTable {
public:
    /// Takes over the blocks of a state. False where blocks and chains are the very same ones as before: then nothing has
    /// changed. Fields whose window would exceed `slot_limit` slots are left out and counted.
    bool rebuild(const InterestState& state, size_t slot_limit, size_t node_limit);

    /// Row of a field, or -1 (such a train reads shift 0, gain 1 and orbit 1).
    int row_of(FieldId id) const { return row_of_chain({id}); }
    /// The same of a train's field with what it lies over.
    int row_of(const WaveTrainBox& record, FieldId field) const {
        return row_of_chain(chain_of(record, field));
    }
    size_t field_count() const { return fields_.size(); }
    size_t block_count() const { return nodes_.size() / (block_nodes * block_nodes); }
    /// Blocks that found no room in the limits.
    size_t left_out() const { return left_out_; }
    /// Largest orbit factor of any node, at least 1.
    float largest_orbit() const { return static_cast<float>(largest_orbit_) / unit_node_orbit; }

    const std::vector<int32_t>& slots() const { return slots_; }
    /// Shift (2^-16 turn); gain (Q1.15) in the low and orbit (Q2.14) in the high half.
    const std::vector<std::array<int32_t, 2>>& nodes() const { return nodes_; }
    /// The rows of all fields relative to an anchor.
    void append_fields(std::vector<std::array<int32_t, 4>>& out, LatticePoint anchor) const;

private:
    struct Field {
        int step_log2 = 16;
        BlockKey first;
        int64_t columns = 0;
        int64_t rows = 0;
        size_t first_slot = 0;
    };
    /// The blocks of a chain that count.
    struct Layered {
        uint8_t step_log2 = 16;
        std::map<BlockKey, std::shared_ptr<const LandBlock>> blocks;
    };
    struct Limits {
        size_t slots = 0;
        size_t nodes = 0;
    };
    int row_of_chain(const FieldChain& chain) const;
    static Layered lay_over(const InterestState& state, const FieldChain& chain);
    void add_field(const FieldChain& chain, const Layered& layered, Limits limits);
    int32_t nodes_of(const std::shared_ptr<const LandBlock>& block);

    std::vector<Field> fields_;
    std::map<FieldChain, int> rows_;  // of every chain known, -1 where it has no blocks or no room
    std::map<const LandBlock*, int32_t> first_node_;
    std::vector<int32_t> slots_;
    std::vector<std::array<int32_t, 2>> nodes_;
    std::vector<std::shared_ptr<const LandBlock>> seen_;
    uint16_t largest_orbit_ = unit_node_orbit;
    size_t left_out_ = 0;
};

}  // namespace trochoid
