#pragma once
#include <memory>
#include <vector>

#include "protocol/model/interest_state.hpp"
#include "server/interest/extra_bounds.hpp"
#include "server/interest/terrain_minima.hpp"
#include "server/world/world_state.hpp"

namespace trochoid {

/// Largest values on one land block.
struct BlockBounds {
    double gain = 1.0;
    double gain_slope = 0.0;   ///< 1/m
    double shift_slope = 0.0;  ///< rad/m
    double orbit = 1.0;
    double orbit_slope = 0.0;  ///< 1/m
};

/// Sums over some trains of a box, before any gain (A amplitude in m, chi choppiness, k rad/m, round waves' turn included).
struct TrainSums {
    double a = 0.0;   ///< sum of A, m
    double h = 0.0;   ///< sum of chi A, m
    double ka = 0.0;  ///< sum of k A
    double kh = 0.0;  ///< sum of chi k A
};

/// A land field's blocks with a dense window for look-ups, ready to be handed on: where the field lies over another, the blocks
/// that count, each under the id of the field that holds it. Immutable and shared between boxes and indices.
struct IndexedBlocks {
    std::shared_ptr<const LandField> field;
    BlockKey first;
    int64_t columns = 0;
    int64_t rows = 0;
    std::vector<int32_t> slots;  ///< index into blocks and bounds, -1 where none lies
    std::vector<FieldBlock> blocks;
    std::vector<BlockBounds> bounds;
};

/// A land field of a box.
struct IndexedField {
    std::shared_ptr<const IndexedBlocks> land;
    TrainSums trains;        ///< of the box's trains that read this field
    size_t first_train = 0;  ///< the first of them: a shorter prefix does not need the field
};

/// A box with what every cull asks of it, made once.
struct IndexedBox {
    std::shared_ptr<const PreparedBox> sea;
    std::vector<IndexedField> fields;
    /// [i]: the longest wavelength of trains i and beyond, m; falls.
    std::vector<double> longest;
    /// [i]: sums over the trains i and beyond; one entry more than trains, the last is 0.
    std::vector<TrainSums> tail;
    TrainSums open;  ///< of the trains without a field
    ExtraBounds wake;
    ExtraBounds noise;              ///< of noise that is part of the authoritative surface
    double longest_noise = 0.0;     ///< m, displayed noise included
    double ramp_slope = 0.0;        ///< largest gradient of the envelope, 1/m
    double modulation = 1.0;        ///< largest factor of irregular heights
    double modulation_slope = 0.0;  ///< 1/m
    double height = 0.0;            ///< m, most that anything of the box lifts or lowers the water
    double displacement = 0.0;      ///< m, most that it shifts the water sideways
};

/// Land that was indexed ahead of the world that it becomes part of, on the thread that traced it: hashing blocks and building the
/// minima take longer than all the rest.
struct IndexedLand {
    std::shared_ptr<const TerrainMinima> terrain;
    std::vector<std::shared_ptr<const IndexedBlocks>> fields;  ///< any order
};

/// What culls of one world share. An immutable value; holds all that it refers to.
class InterestIndex {
public:
    /// Boxes, land fields and terrain that `previous` or `ahead` hold too (the same objects) are taken over, not made again. The
    /// result is the same with and without them.
    explicit InterestIndex(const WorldState& world, const InterestIndex* previous = nullptr,
                           const IndexedLand& ahead = {});

    LogPosition log_position() const { return log_position_; }
    /// Ascending id.
    const std::vector<std::shared_ptr<const IndexedBox>>& boxes() const { return boxes_; }
    /// The box of an id; nullptr where there is none.
    const IndexedBox* find(BoxId box) const;
    /// nullptr over open sea.
    const TerrainMinima* terrain() const { return terrain_.get(); }

private:
    LogPosition log_position_;
    std::vector<std::shared_ptr<const IndexedBox>> boxes_;
    std::shared_ptr<const TerrainMinima> terrain_;
};

/// A traced field, ready for an index. Where it lies over a field of `before` (nullptr: none), only its own blocks are looked at.
std::shared_ptr<const IndexedBlocks> index_blocks(std::shared_ptr<const LandField> field,
                                                  const IndexedBox* before);

}  // namespace trochoid
