#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/units/ids.hpp"
#include "protocol/units/lattice.hpp"
#include "protocol/units/result.hpp"

namespace trochoid {

/// Cells along a side of a block; a block holds one node more, so every cell lies in one block.
inline constexpr int block_cells = 16;
inline constexpr int block_nodes = block_cells + 1;
/// Gain 1 of a node, Q1.15; the largest is 65535 (just below 2).
inline constexpr uint16_t unit_node_gain = 1 << 15;

/// Orbit factor 1 of a node, Q2.14; the largest is 65535 (just below 4).
inline constexpr uint16_t unit_node_orbit = 1 << 14;

/// Place of a block on its field's lattice: it covers the cells [16*x, 16*x+16) × [16*z, 16*z+16).
struct BlockKey {
    int32_t x = 0;
    int32_t z = 0;
    auto operator<=>(const BlockKey&) const = default;
};

/// What land does to one band of wave trains at 17 × 17 nodes (row-major, z grows with the row). Neighbouring blocks
/// repeat the nodes of their common edge with equal values.
struct LandBlock {
    BlockKey key;
    /// Phase shift in 2^-16 turn, |shift| < 2^30; neighbouring nodes of a cell differ by less than 2^23 (128 turns).
    std::array<int32_t, block_nodes * block_nodes> shift{};
    /// Gain, Q1.15.
    std::array<uint16_t, block_nodes * block_nodes> gain{};
    /// Horizontal over vertical orbit beyond the train's own choppiness (coth kD in shallow water; row B14), Q2.14.
    std::array<uint16_t, block_nodes* block_nodes> orbit = unit_orbits();
    static constexpr std::array<uint16_t, block_nodes * block_nodes> unit_orbits() {
        std::array<uint16_t, block_nodes * block_nodes> ones{};
        for (uint16_t& one : ones) one = unit_node_orbit;
        return ones;
    }
    bool operator==(const LandBlock&) const = default;
};

/// True where every node reads shift 0, gain 1 and orbit 1: such a block is not sent, but for a field with a base, whose block it hides.
bool trivial(const LandBlock& block);
Result<Done> validate(const LandBlock& block);

/// Shift and gain at a point with their gradients.
struct LandSample {
    uint32_t shift = 0;        ///< turns, Q0.32
    uint32_t gain = 1U << 24;  ///< Q1.24 (below 2^25)
    float dshift_dx = 0.0F;    ///< rad/m
    float dshift_dz = 0.0F;
    float dgain_dx = 0.0F;  ///< 1/m
    float dgain_dz = 0.0F;
    float orbit = 1.0F;      ///< factor on the horizontal orbit
    float dorbit_dx = 0.0F;  ///< 1/m
    float dorbit_dz = 0.0F;
    bool operator==(const LandSample&) const = default;
};

/// A field on a global node lattice (model: "Land"; rows A5, A7): phase shift and gain per node for one band of one box.
/// A point without a block reads shift 0 and gain 1. Blocks are immutable and shared. A copy shares the window of look-up slots until
/// one of the two sets a block; whoever else reads a field or copies it, only its maker sets.
class LandField {
public:
    LandField() = default;
    /// Nodes lie at multiples of 2^step_log2 lattice units, step_log2 in 12 (4 m) to 20 (1 km).
    LandField(FieldId id, uint8_t step_log2);

    FieldId id() const { return id_; }
    uint8_t step_log2() const { return step_log2_; }
    /// Whether a block there keeps the field's window of look-up slots within its limit (a peer may send anything).
    bool fits(BlockKey key) const;
    /// Makes room for blocks from `first` to `last` (inclusive, both have to fit), so that setting them does not grow the window again
    /// and again.
    void make_room(BlockKey first, BlockKey last);
    /// Look-up slots of the window, 16 bytes each.
    size_t slot_count() const { return static_cast<size_t>(columns_) * static_cast<size_t>(rows_); }
    /// Adds or replaces the block, which must fit.
    void set(std::shared_ptr<const LandBlock> block);
    /// The field that counts where this one has no block (WaveTrainBox::overlays); same step. nullptr: open water.
    void set_base(std::shared_ptr<const LandField> base);
    const std::shared_ptr<const LandField>& base() const { return base_; }
    /// The block that counts there, this field's own or its bases'; nullptr where no block lies.
    const LandBlock* find(BlockKey key) const;
    std::shared_ptr<const LandBlock> share(BlockKey key) const;
    /// The field's own blocks, without its bases', by ascending (z, x).
    std::vector<std::shared_ptr<const LandBlock>> blocks() const;
    size_t block_count() const { return count_; }

    /// Bilinear in integers (model: "Land"): the same on every CPU and GPU.
    LandSample sample(LatticePoint p) const;

private:
    struct Window {
        BlockKey first;
        int64_t columns = 0;
        int64_t rows = 0;
    };
    using Slots = std::vector<std::shared_ptr<const LandBlock>>;
    Window window_with(BlockKey key) const;
    void grow_to(const Window& window);
    size_t slot_of(BlockKey key) const;
    const std::shared_ptr<const LandBlock>* own_slot(BlockKey key) const;

    FieldId id_;
    uint8_t step_log2_ = 16;
    // A dense window of slots over the blocks' bounding rectangle: look-ups cost two subtractions.
    BlockKey first_;
    int32_t columns_ = 0;
    int32_t rows_ = 0;
    size_t count_ = 0;
    std::shared_ptr<const LandField> base_;
    std::shared_ptr<Slots> slots_;  // shared with copies; null while the window is empty
};

/// Blocks of a field whose cells touch the rectangle: [first, last] inclusive in both axes.
struct BlockRange {
    BlockKey first;
    BlockKey last;
};
BlockRange blocks_touching(const LatticeRect& rect, uint8_t step_log2);

}  // namespace trochoid
