#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "protocol/model/sea.hpp"
#include "protocol/model/simd/sea_grid.hpp"

namespace trochoid::simd {

/// Points that are worked on at once: a row of a tile, or a handful of places. A multiple of every target's vector.
inline constexpr int span_points = 64;
/// Rows of a tile: culling and the look-up of land blocks are shared by span_points x tile_rows points.
inline constexpr int tile_rows = 16;

/// What the inner loop needs of one train, ready to be broadcast: every product as the reference rounds it.
struct TrainRow {
    uint32_t kx = 0;     ///< turns per grid step (grids) or lattice unit (places)
    uint32_t kz = 0;     ///< the same
    uint32_t phase = 0;  ///< at grid point (0, 0), or at the world's origin
    float g = 0.0F;      ///< gain where the box's envelope is full
    float hx = 0.0F, a = 0.0F, hz = 0.0F;
    float akx = 0.0F, akz = 0.0F;
    float hxkx = 0.0F, hxkz = 0.0F, hzkx = 0.0F, hzkz = 0.0F;
    float vx = 0.0F, vy = 0.0F, vz = 0.0F;
    // For the general loop alone.
    float wave_kx = 0.0F, wave_kz = 0.0F;
    uint32_t round_wave_number = 0;  ///< (whole * roundness) >> 15
    int32_t local = 0;               ///< 0: no field; else 1 + index of the box's field
};

/// Ramps of one side, as the vector code wants them.
struct SideRamp {
    int32_t length = 0;
    uint32_t reciprocal = 0;
    float slope = 0.0F;
};

/// The blocks around all of a plan's points on the lattice of one step, as fields lay them out in a table.
struct PlannedLattice {
    BlockKey first;
    uint32_t columns = 0;  ///< 0: no field has the step, or its blocks are too many for a table
    uint32_t rows = 0;
    /// The blocks' places in a table, row by row, in 32 bits that wrap; every point of the plan has one.
    uint32_t place(BlockKey key) const {
        return (static_cast<uint32_t>(key.z) - static_cast<uint32_t>(first.z)) * columns +
               (static_cast<uint32_t>(key.x) - static_cast<uint32_t>(first.x));
    }
};
PlannedLattice lattice_around(const LatticeRect& rect, int step);

/// A field with its blocks by their PlannedLattice::place.
struct PlannedField {
    const LandField* field = nullptr;
    /// open_block() where the field has none; empty where they are too many.
    std::vector<const LandBlock*> blocks;
    bool everywhere = false;  ///< no place of the table is open water
};
/// What a field reads where it has no block, as a block.
const LandBlock& open_block();

/// Trains of a box that follow each other and are shaped alike.
struct TrainRun {
    int32_t first_row = 0;  ///< of the plan's
    int32_t rows = 0;
    int32_t local = 0;  ///< TrainRow::local
};

/// A box of the sea with what does not depend on the point.
struct PlannedBox {
    const LiveBox* live = nullptr;
    int32_t first_row = 0;
    int32_t rows = 0;
    std::vector<TrainRun> runs;  ///< its rows, in order
    bool limited = false;
    bool unit_gain = false;  ///< the full envelope is 1
    bool uneven = false;     ///< irregular heights
    bool round = false;
    bool wake = false;
    bool noise = false;
    bool open_rows = false;  ///< some train has no field
    float ux = 1.0F, uz = 0.0F;
    SideRamp rear, front, side;
    uint64_t width_reciprocal = 0;  ///< 2^40 / width
    /// Irregular heights.
    float share = 0.0F;
    float ukx = 0.0F, ukz = 0.0F, vkx = 0.0F, vkz = 0.0F;  ///< rad/m
    /// The box's fields that are switched on and have blocks, as PreparedBox orders them; empty where land is switched off.
    std::vector<PlannedField> fields;
    size_t first_field = 0;  ///< index of the first among all boxes' fields
};

struct Plan {
    const SeaInstant* sea = nullptr;
    std::vector<TrainRow> rows;
    std::vector<PlannedBox> boxes;
    bool shelter = true;
    bool refraction = true;
    bool orbits = true;
    size_t most_fields = 0;  ///< of a box
    size_t all_fields = 0;
    uint32_t steps = 0;                        ///< bit n: some field has the step 2^n
    std::array<PlannedLattice, 9> lattices{};  ///< of steps 2^12 to 2^20
    const PlannedLattice& lattice_of(const LandField& field) const {
        return lattices[static_cast<size_t>(field.step_log2() - 12)];
    }
};

/// Steps: lattice units of a grid step along x and z; 1 for places. Boxes that are still water all over `rect` are left out.
Plan plan_of(const SeaInstant& sea, LatticePoint origin, int64_t step_x, int64_t step_z,
             const LatticeRect& rect);

enum class Cover : uint8_t {
    none,    ///< the envelope is 0 at every point
    full,    ///< the envelope is the time's gain at every point, without gradient
    varied,  ///< anything
};
/// What a box's envelope is over a rectangle. Exact: `none` and `full` hold at every lattice point in it.
Cover cover_of(const PlannedBox& box, const LatticeRect& rect);

/// How a stretch of trains is summed over a tile.
struct Stretch {
    enum class Kind : uint8_t { fast_unit, fast, general, tail };
    Kind kind = Kind::fast;
    int32_t first_row = 0;
    int32_t rows = 0;
    size_t first_run = 0;             ///< general
    const PlannedBox* box = nullptr;  ///< general and tail (wake and noise)
    bool full = false;                ///< general and tail: the box's envelope is full
};
/// Whether some box's envelope varies.
bool varies(const std::vector<Stretch>& stretches);
/// The stretches of a rectangle in the order of the sum; boxes that do not touch it leave none.
void stretches_of(const Plan& plan, const LatticeRect& rect, std::vector<Stretch>& out);

}  // namespace trochoid::simd
