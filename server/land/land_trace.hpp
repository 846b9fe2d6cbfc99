#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/model/terrain.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "server/land/land_settings.hpp"
#include "server/land/wave_bands.hpp"
#include "server/world/traced_land.hpp"

namespace trochoid {

/// What a trace came to, for logs, overlays and tests.
struct LandTraceStats {
    /// Node step really used (LandSettings::nodes_max).
    uint8_t step_log2 = 0;
    uint32_t bands = 0;
    uint64_t nodes_per_band = 0;
    uint64_t blocks = 0;
    /// Rows of the march over all bands, and their columns (ray steps).
    uint64_t rows_marched = 0;
    uint64_t ray_steps = 0;
    /// Columns whose phase slope across was cut to 60 turns a node.
    uint64_t cut_slopes = 0;
    /// Cells in which gains were lowered because waves became too steep (LandSettings::steepness_max).
    uint64_t limited_cells = 0;
    /// Largest change of the shift between neighbouring nodes, and of that change from one cell to the next, in turns, where the
    /// gain is above 0.1 at all nodes concerned, inside the blocks.
    double largest_step = 0.0;
    double largest_bend = 0.0;
    /// Cells along x whose bend is above 1/2 turn, and all cells along x with gain above 0.1.
    uint64_t bent_cells = 0;
    uint64_t live_cells = 0;
    bool operator==(const LandTraceStats&) const = default;
};

/// Traces what the land does to a box over all that it will ever cover (rows A5, A7; model: "Land"): one field per band of trains
/// (wave_bands), with consecutive ids from first_field in the order of the bands' first trains. Bands that the land does not
/// touch get no field. The result depends on the arguments alone, never on the number of threads; terrain and settings must be
/// without fault, the box valid. A box with a course is traced over the whole terrain.
TracedLand trace_land(const WaveTrainBox& box, const TerrainGrid& terrain, FieldId first_field,
                      const LandSettings& settings, LandTraceStats* stats = nullptr);

/// The band with most energy: its waves' rays are shown.
const WaveBand& dominant_band(const std::vector<WaveBand>& bands);

/// A field with these blocks, ascending (z, x).
std::shared_ptr<LandField> make_land_field(FieldId id, uint8_t step_log2,
                                           std::span<const std::shared_ptr<const LandBlock>> blocks);

/// The same land with ids that follow on from another first field; blocks are shared, not copied. Fields below, of a predecessor, keep
/// theirs.
TracedLand with_first_field(const TracedLand& land, FieldId first_field);

/// 64-bit FNV-1a over every field's blocks, overlays, the trains' fields, gain_max, steepness growths and the rays: the same on every
/// machine.
uint64_t hash_of(const TracedLand& land);

}  // namespace trochoid
