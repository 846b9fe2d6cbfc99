#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/model/terrain.hpp"
#include "protocol/model/wave_ray.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "server/land/land_settings.hpp"
#include "server/land/wave_bands.hpp"

namespace trochoid {

/// Most rays that a box shows.
inline constexpr int wave_rays_max = 128;

/// Rays of an earlier trace that a change of the land may have left as they are.
struct RayReuse {
    std::span<const WaveRay> rays;
    /// Where heights may have changed.
    LatticeRect changed;
    /// Rays that had to be walked.
    uint64_t walked = 0;
};

/// Straight rays along the box's u where it lies at its beginning, evenly spaced across it, from its rear to its front (an unlimited
/// side: over the terrain and its belt), with the points where the waves of `band` change, in order of travel. Walked in half
/// node steps (at most 8192) with the march's own rules for one direction: shoaling starts below half a wave length of depth
/// (kD < pi; armed again in a quarter more), land blocks, water begins again, and the height is recovered when the share is
/// back at 1. `blocked` and `water_again` alternate, and `recovered` follows a `water_again`. At most wave_rays_max.
std::vector<WaveRay> wave_rays(const WaveTrainBox& box, const TerrainGrid& terrain, const WaveBand& band,
                               const LandSettings& settings, RayReuse* reuse = nullptr);

}  // namespace trochoid
