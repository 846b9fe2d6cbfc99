#pragma once
#include <cstdint>

#include "protocol/units/lattice.hpp"
#include "protocol/units/result.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// Largest share a/A, Q1.15 (1.0).
inline constexpr uint16_t full_irregularity = 1 << 15;

/// Irregular heights (paper A, eq. 8; row A8): every gain of the box is multiplied by 1 - (a/A) sin(p_u) sin(p_v), with
/// p_u = uk . (X, Z) + phase_u - omega T and p_v = vk . (X, Z) + phase_v, uint32 phases as a train's (global coordinates,
/// exact anywhere). share = 0 switches it off.
struct IrregularHeight {
    uint16_t share = 0;  ///< a/A, Q1.15, 0 to full_irregularity
    int32_t ukx = 0;     ///< turns per lattice unit, Q0.32, along the travel direction
    int32_t ukz = 0;
    int32_t vkx = 0;  ///< across
    int32_t vkz = 0;
    uint64_t omega = 0;  ///< turns per microsecond, Q0.64; groups travel at omega / |uk|
    uint32_t phase_u = 0;
    uint32_t phase_v = 0;
    bool operator==(const IrregularHeight&) const = default;
};

/// The time part: phases at the origin of the world at one sea time.
struct IrregularPhases {
    uint32_t u = 0;
    uint32_t v = 0;
};
IrregularPhases phases_at_origin(const IrregularHeight& irregular, SeaTime t);

/// Factor on the gain and its gradient per metre.
struct HeightModulation {
    float factor = 1.0F;
    float dx = 0.0F;
    float dz = 0.0F;
    bool operator==(const HeightModulation&) const = default;
};
/// Float32 in a written order (protocol/README.md, "Irregular heights"); share 0 gives exactly 1, 0, 0.
HeightModulation modulation_at(const IrregularHeight& irregular, const IrregularPhases& at_origin,
                               LatticePoint p);

Result<Done> validate(const IrregularHeight& irregular);

}  // namespace trochoid
