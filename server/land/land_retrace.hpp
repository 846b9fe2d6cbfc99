#pragma once
#include <cstdint>

#include "protocol/model/terrain.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "server/land/land_settings.hpp"
#include "server/world/traced_land.hpp"

namespace trochoid {

/// What a changed land came to for one box.
struct RetraceStats {
    /// Nothing of the old trace could be used: it was of another box, terrain extent or settings.
    bool whole = false;
    /// Nodes whose depth has changed.
    uint64_t changed_nodes = 0;
    uint32_t bands = 0;
    /// Bands that were marched again, and those whose blocks changed.
    uint32_t bands_traced = 0;
    uint32_t bands_changed = 0;
    /// Rows of the march that a whole trace of all bands has, and those marched.
    uint64_t rows = 0;
    uint64_t rows_marched = 0;
    uint64_t blocks_compared = 0;
    uint64_t blocks_changed = 0;
    uint64_t rays = 0;
    uint64_t rays_walked = 0;
    bool operator==(const RetraceStats&) const = default;
};

/// Traces a box whose land has changed while the sea runs (row A5): `old` is the trace of its predecessor over `before`, `successor` the
/// same box over `after` (ids, times and phases may differ), and heights differ inside `changed` alone (with what the belt around
/// the terrain makes of its border). Bands that the change does not touch keep their fields' ids; of the others only the rows
/// from the change on are marched again, only the blocks that the march then reaches with other values are decided again, and `fields` holds, with consecutive ids from first_field, only the blocks that
/// differ, blocks that have become open water too; `overlays` tells over which old fields they lie (none: a band that was
/// open water). gain_max, steepness growths and rays are the whole result's. Equal to a trace_land over `after`, bit for
/// bit, where the overlay chain is followed.
TracedLand retrace_land(const WaveTrainBox& successor, const TracedLand& old, const TerrainGrid& before,
                        const TerrainGrid& after, const LatticeRect& changed, FieldId first_field,
                        const LandSettings& settings, RetraceStats* stats = nullptr);

}  // namespace trochoid
