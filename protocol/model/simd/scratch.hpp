#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "protocol/model/ordered_sum.hpp"
#include "protocol/model/simd/plan.hpp"

namespace trochoid::simd {

template <class T>
using SpanOf = std::array<T, span_points>;

/// The accumulators of the ordered sum for a span, in the reference's order.
struct alignas(64) SpanSums {
    SpanOf<float> ax, ay, az, bx, bz, mxx, mxz, mzx, mzz, vx, vy, vz;
};
/// Those of one point.
inline Sums sums_at(const SpanSums& m, size_t i) {
    return {m.ax[i],  m.ay[i],  m.az[i],  m.bx[i], m.bz[i], m.mxx[i],
            m.mxz[i], m.mzx[i], m.mzz[i], m.vx[i], m.vy[i], m.vz[i]};
}

/// A box's envelope over a span.
struct alignas(64) SpanEnvelope {
    SpanOf<uint32_t> gain;
    SpanOf<float> dx, dz;
    SpanOf<int32_t> u, v;  ///< clamped to [0, 2^30]
    // Round waves: distance from the middle, its share of the width (Q0.31 of round_shift), and the sign bit of the side.
    SpanOf<uint32_t> off, part, side;
    SpanOf<float> factor, factor_dx, factor_dz;  ///< irregular heights
};

/// What the trains of one field need at a vector's points.
enum class SpanNeeds : uint8_t {
    nothing,  ///< every gain is 0
    gain,     ///< no gradient is other than 0, and the horizontal gain is the vertical one
    all,
};

/// What shapes the trains of one field (or of none) over a span: SeaInstant's `Local`, one array a value.
struct alignas(64) SpanLocal {
    SpanOf<uint32_t> shift;
    SpanOf<float> g, gx, gz, gh, ghx, ghz, qx, qz;
    /// Per vector, by its first point: what the trains need.
    SpanOf<SpanNeeds> needs;
};

/// The cells of the points of a span on lattices of one step, and which of them are new.
struct alignas(64) SpanPlaces {
    SpanOf<int32_t> column, row;
    SpanOf<uint32_t> block;      ///< PlannedLattice::place, if the lattice has a table
    SpanOf<uint32_t> node;       ///< the cell's north-west node in its block
    SpanOf<int32_t> in_x, in_z;  ///< in the cell, Q0.16
    SpanOf<uint8_t> changed;     ///< the first `changes` are indices of points
    int32_t changes = 0;
    size_t count = 0;      ///< points that are set
    uint32_t version = 0;  ///< grows where a point has come into another cell; 0: never set
};

/// The nodes around each point of a span in one field; kept while the points stay in their cells.
struct alignas(64) SpanCells {
    /// Shifts of the west node and of the east node, point by point: rows z and z + 1.
    std::array<int32_t, 2 * size_t{span_points}> shift0, shift1;
    /// West node in the low half, east node in the high half: rows z and z + 1.
    SpanOf<uint32_t> gain0, gain1, orbit0, orbit1;
    uint32_t version = 0;  ///< that of the places
};

/// Phases of a train at a vector's points, with room for the longest, and how far ahead the next ones are: those of the next vector
/// in the row, and from a row's last vector those of the next row's first.
struct alignas(64) PhaseVector {
    std::array<uint32_t, 16> turns;
    std::array<uint32_t, 2> moves;
};

struct Scratch {
    /// Points in use, rounded up to whole vectors of every target; the points beyond the last repeat it.
    size_t padded = span_points;
    SpanSums sums{};
    SpanEnvelope envelope{};
    alignas(64) SpanOf<int64_t> x{}, z{};
    alignas(64) SpanOf<uint32_t> x_low{}, z_low{};
    std::vector<SpanLocal> locals;
    std::array<SpanPlaces, 9> places{};  ///< of steps 2^12 to 2^20
    std::vector<SpanCells> cells;        ///< by PlannedBox::first_field + field
    std::vector<PhaseVector> phases;     ///< one a train
    std::vector<Stretch> stretches;
    explicit Scratch(const Plan& plan)
        : locals(plan.most_fields + 1), cells(plan.all_fields), phases(plan.rows.size()) {}
};

/// Nodes around the points: looks up what has changed since the last call.
void load_cells(const PlannedField& field, const SpanPlaces& places, SpanCells& cells);

/// n rounded up to the longest vector.
inline size_t padded_count(int n) { return (static_cast<size_t>(n) + 15) & ~size_t{15}; }

/// The box's wake at the first n points, one by one, from its envelope.
void add_wake(const PlannedBox& box, Scratch& at, int n);

}  // namespace trochoid::simd
