#pragma once
#include <cstdint>
#include <vector>

#include "protocol/units/lattice.hpp"

namespace trochoid {

/// What a client looks through. Frame: x east, y up, z south, right-handed; the camera looks along -z of its quaternion.
struct ViewState {
    LatticePoint position;  ///< lattice units
    int32_t altitude = 0;   ///< camera height above still water, lattice units (positive up)
    float qx = 0.0F, qy = 0.0F, qz = 0.0F, qw = 1.0F;  ///< unit quaternion, camera to world
    float tan_half_width = 1.0F;                       ///< tangent of the horizontal half-angle, 0.01 to 20
    float tan_half_height = 0.6F;                      ///< tangent of the vertical half-angle, 0.01 to 20
    uint16_t viewport_width = 1280;                    ///< pixels, 1 to 16384
    uint16_t viewport_height = 720;
    float vx = 0.0F, vy = 0.0F, vz = 0.0F;  ///< velocity of the camera, m/s, each at most 10,000
    float accepted_error_px = 1.0F;         ///< accepted height error on the screen, pixels, 0.1 to 100
    uint32_t patch_budget = 512;            ///< most patches wanted, 1 to 1024
    bool operator==(const ViewState&) const = default;
};

/// A disc in which a client needs the full, unfiltered sea whether it looks there or not (hulls, sensors).
struct SyncRegion {
    LatticePoint centre;
    uint32_t radius = 0;  ///< lattice units, up to 2 km
    bool operator==(const SyncRegion&) const = default;
};

}  // namespace trochoid
