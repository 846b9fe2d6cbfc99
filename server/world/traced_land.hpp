#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/model/land_field.hpp"
#include "protocol/model/wave_ray.hpp"
#include "protocol/units/ids.hpp"

namespace trochoid {

/// What the land does to one box, traced once over all that the box will ever cover (row A5): the result of server/land
/// as the world takes it in. A default one is open water: no fields, gain 1, no rays.
struct TracedLand {
    /// One field per band, ascending id; the ids follow on from the world's next_field without a gap.
    std::vector<std::shared_ptr<const LandField>> fields;
    /// For each train of the box the id of its field, or none (0); empty: none for all.
    std::vector<FieldId> field_of_train;
    /// Largest gain over all fields, Q1.15 (32768 = 1); never below 1, for the box's open water.
    uint16_t gain_max = unit_node_gain;
    /// Largest product of gain and |k'|/k over all nodes: how much steeper than on open water the land can make the box.
    /// Refraction and shoaling shorten waves; 1 counts nothing beyond gain_max.
    float steepness_growth = 1.0F;
    /// Rays along u with their action points, at most 128; for debug views.
    std::vector<WaveRay> rays;
};

}  // namespace trochoid
