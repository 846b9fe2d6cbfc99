#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/model/land_field.hpp"
#include "protocol/model/wave_ray.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "protocol/units/ids.hpp"

namespace trochoid {

/// What a trace keeps so that a later one over changed land need not start anew (server/land).
struct LandMemory;

/// What the land does to one box, traced once over all that the box will ever cover (row A5): the result of server/land
/// as the world takes it in. A default one is open water: no fields, gain 1, no rays.
struct TracedLand {
    /// New fields, one per band, ascending id; the ids follow on from the world's next_field without a gap. After a change of the
    /// land (retrace_land) only those of the bands that it changes.
    std::vector<std::shared_ptr<const LandField>> fields;
    /// For each train of the box the id of its field, or none (0); empty: none for all. After a change of the land also ids of the
    /// predecessor's fields, for bands that the change does not touch.
    std::vector<FieldId> field_of_train;
    /// After a change of the land: which of `fields` hold only the blocks that changed and lie over a field of the predecessor;
    /// ascending by field.
    std::vector<FieldOverlay> overlays;
    /// Largest gain over all fields, Q1.15 (32768 = 1); never below 1, for the box's open water.
    uint16_t gain_max = unit_node_gain;
    /// How much steeper than on open water the land can make the box: each band's largest product of gain, orbit and |k'|/k, at
    /// least 1, weighted by its sum of A k. Right where all trains have one choppiness; a box whose trains differ in it
    /// has to count with the largest band's.
    float steepness_growth = 1.0F;
    float steepness_growth_most = 1.0F;
    /// Rays along u with their action points, at most 128; for debug views.
    std::vector<WaveRay> rays;
    /// Never decides a result; null where nothing is remembered.
    std::shared_ptr<const LandMemory> memory;
};

/// Blocks of the new fields.
inline size_t blocks_of(const TracedLand& land) {
    size_t blocks = 0;
    for (const auto& field : land.fields) blocks += field->block_count();
    return blocks;
}

}  // namespace trochoid
