#include "server/land/land_retrace.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"
#include "server/land/band_trace.hpp"
#include "server/land/land_trace.hpp"
#include "server/land/ray_trace.hpp"

namespace trochoid {

namespace {

/// A node whose depth has changed, with the lesser of the two.
struct ChangedNode {
    int32_t x;
    int32_t z;
    float depth;
};

/// Where heights may differ: a sample shapes the cells around it, one of the border the belt outside.
LatticeRect reach_of(const TerrainGrid& terrain, const LatticeRect& changed) {
    const int64_t spacing = int64_t{1} << terrain.spacing_log2;
    const LatticeRect belt = belt_bounds(terrain);
    const int64_t far_x = terrain.origin_x + (int64_t{terrain.columns} - 1) * spacing;
    const int64_t far_z = terrain.origin_z + (int64_t{terrain.rows} - 1) * spacing;
    LatticeRect reach{{changed.min.x - spacing, changed.min.z - spacing},
                      {changed.max.x + spacing, changed.max.z + spacing}};
    if (reach.min.x <= terrain.origin_x) reach.min.x = std::min(reach.min.x, belt.min.x);
    if (reach.min.z <= terrain.origin_z) reach.min.z = std::min(reach.min.z, belt.min.z);
    if (reach.max.x >= far_x) reach.max.x = std::max(reach.max.x, belt.max.x);
    if (reach.max.z >= far_z) reach.max.z = std::max(reach.max.z, belt.max.z);
    return reach;
}

std::vector<ChangedNode> changed_nodes(const TraceInput& in, const TerrainGrid& before,
                                       const LatticeRect& reach) {
    std::vector<ChangedNode> nodes;
    const BlockRange touched = blocks_touching(reach, in.area.step_log2);
    LandArea part = in.area;
    part.first = {std::max(touched.first.x, in.area.first.x), std::max(touched.first.z, in.area.first.z)};
    part.blocks_x = std::min(touched.last.x + 1, in.area.first.x + in.area.blocks_x) - part.first.x;
    part.blocks_z = std::min(touched.last.z + 1, in.area.first.z + in.area.blocks_z) - part.first.z;
    if (part.empty()) return nodes;
    const std::vector<float> old = node_depths(part, in.box, before, in.settings.run_up);
    const int32_t x0 = (part.first.x - in.area.first.x) * block_cells;
    const int32_t z0 = (part.first.z - in.area.first.z) * block_cells;
    size_t n = 0;
    for (int32_t z = 0; z < part.nodes_z(); ++z) {
        const float* const row =
            in.depths.data() + static_cast<size_t>(z0 + z) * static_cast<size_t>(in.area.nodes_x()) + x0;
        for (int32_t x = 0; x < part.nodes_x(); ++x, ++n)
            if (row[x] != old[n]) nodes.push_back({x0 + x, z0 + z, std::min(row[x], old[n])});
    }
    return nodes;
}

/// Same bands over the same nodes by the same rules.
bool fits(const LandMemory& memory, const TraceInput& in) {
    LandSettings settings = memory.settings;
    settings.threads = in.settings.threads;
    return memory.area == in.area && memory.bands == in.bands && memory.height == in.height &&
           settings == in.settings && !in.area.empty();
}

/// What becomes of one band.
struct BandChange {
    bool traced = false;
    std::vector<std::shared_ptr<const LandBlock>> blocks;
    std::shared_ptr<const BandMemory> memory;
    uint64_t rows_marched = 0;
    uint64_t compared = 0;
};

/// From where on a band may have changed; false: nowhere.
bool restart_of(BandRestart& restart, const TraceInput& in, const BandView& view, const BandMemory& memory,
                const std::vector<ChangedNode>& nodes, const BandGrid& frame) {
    const auto untouched = static_cast<float>(response_of(in, view.band).untouched());
    const LandArea& area = *view.area;
    restart.tile_hashes = memory.tile_hashes;
    restart.blocks.assign(static_cast<size_t>(area.blocks_x) * static_cast<size_t>(area.blocks_z), 0);
    bool any = false;
    for (const ChangedNode& node : nodes) {
        if (node.depth >= untouched) continue;
        const int32_t x = view.turned ? node.z : node.x;
        const int32_t z = view.turned ? node.x : node.z;
        const double along = static_cast<double>(x) * view.band.dx + static_cast<double>(z) * view.band.dz;
        if (!any || along < restart.along) restart.along = along;
        any = true;
        // A node on a border belongs to the blocks on both sides.
        for (const int32_t bz : {(z - 1) / block_cells, z / block_cells})
            for (const int32_t bx : {(x - 1) / block_cells, x / block_cells})
                if (bx < area.blocks_x && bz < area.blocks_z)
                    restart.blocks[static_cast<size_t>(bz) * static_cast<size_t>(area.blocks_x) +
                                   static_cast<size_t>(bx)] = 1;
    }
    if (!any) return false;
    // A depth shows in the phase depths some nodes around and in the samples of the rows next to those.
    restart.along = restart.along - 1.5 * static_cast<double>(phase_depth_passes(in.area, view.band)) - 4.0;
    const double centre = frame.centre_x * view.band.dx + frame.centre_z * view.band.dz;
    const double good = (restart.along - restart_margin - centre + frame.centre_row) / frame.row_step;
    for (const MarchCheckpoint& checkpoint : memory.checkpoints)
        if (static_cast<double>(checkpoint.row) <= good) restart.checkpoints.push_back(checkpoint);
    return true;
}

/// Null stands for open water.
bool same_water(const LandBlock* a, const LandBlock* b) {
    if (a != nullptr && trivial(*a)) a = nullptr;
    if (b != nullptr && trivial(*b)) b = nullptr;
    if (a == nullptr || b == nullptr) return a == b;
    return *a == *b;
}

void compare_blocks(BandChange& change, BandMemory& memory, const TraceInput& in, const BandView& view,
                    const BandOutcome& outcome, const TraceWorkspace& work, const LandField* field) {
    for (int32_t bz = 0; bz < in.area.blocks_z; ++bz) {
        for (int32_t bx = 0; bx < in.area.blocks_x; ++bx) {
            const size_t at = block_index(view, bx, bz);
            if (!outcome.decided.empty() && outcome.decided[at] == 0) continue;
            if (view.touching[at] == 0) continue;
            ++change.compared;
            memory.growth[at] = outcome.touched ? outcome.growth.squared[at] : 1.0F;
            const BlockKey key{in.area.first.x + bx, in.area.first.z + bz};
            const bool live = outcome.touched && work.live[at] != 0;
            const LandBlock* const before = field != nullptr ? field->find(key) : nullptr;
            if (!live && before == nullptr) continue;
            const auto block = std::make_shared<LandBlock>();
            block->key = key;
            block->gain.fill(unit_node_gain);
            if (live) copy_block_of(*block, in, view, work.field, bx, bz);
            if (!same_water(block.get(), before)) change.blocks.push_back(block);
        }
    }
}

BandChange retrace_band(const TraceInput& in, size_t index, const LandMemory& old,
                        const std::vector<ChangedNode>& nodes, TraceWorkspace& work) {
    BandChange change;
    change.memory = old.marches[index];
    const BandView view = in.view(index);
    set_frame(work.grid, *view.area, view.band, in.settings);
    BandRestart restart;
    if (!restart_of(restart, in, view, *old.marches[index], nodes, work.grid)) return change;
    change.traced = true;
    const BandOutcome outcome = trace_band(in, index, work, &restart);
    change.rows_marched = outcome.touched ? work.grid.rows_marched : 0;
    outcome.memory->growth = old.marches[index]->growth;
    if (outcome.memory->growth.empty())
        outcome.memory->growth.assign(
            static_cast<size_t>(in.area.blocks_x) * static_cast<size_t>(in.area.blocks_z), 1.0F);
    compare_blocks(change, *outcome.memory, in, view, outcome, work, old.fields[index].get());
    change.memory = outcome.memory;
    return change;
}

uint16_t largest_gain(const LandField& field, const LandArea& area) {
    uint16_t most = unit_node_gain;
    for (int32_t z = area.first.z; z < area.first.z + area.blocks_z; ++z)
        for (int32_t x = area.first.x; x < area.first.x + area.blocks_x; ++x)
            if (const LandBlock* block = field.find({x, z})) most = std::max(most, largest_gain(*block));
    return most;
}

uint64_t whole_rows(const TraceInput& in) {
    uint64_t rows = 0;
    BandGrid frame;
    for (size_t i = 0; i < in.bands.size(); ++i) {
        const BandView view = in.view(i);
        set_frame(frame, *view.area, view.band, in.settings);
        rows += static_cast<uint64_t>(frame.rows);
    }
    return rows;
}

/// The bands' changes as fields over the old ones.
void take_changes(TracedLand& land, const TraceInput& in, const LandMemory& old,
                  std::vector<BandChange>& changes, FieldId first_field) {
    auto memory = std::make_shared<LandMemory>(old);
    std::vector<FieldId> field_of_train(in.box.trains.size());
    std::vector<float> growths;
    bool any = false;
    for (size_t i = 0; i < in.bands.size(); ++i) {
        BandChange& change = changes[i];
        memory->marches[i] = change.memory;
        if (!change.blocks.empty()) {
            const FieldId id{first_field.value + static_cast<uint32_t>(land.fields.size())};
            const auto field = make_land_field(id, in.area.step_log2, change.blocks);
            if (old.fields[i]) {
                field->set_base(old.fields[i]);
                land.overlays.push_back({id, old.fields[i]->id()});
            }
            land.fields.push_back(field);
            memory->fields[i] = field;
        }
        float growth = 1.0F;
        for (const float square : change.memory->growth) growth = std::max(growth, std::sqrt(square));
        growths.push_back(growth);
        if (!memory->fields[i]) continue;
        any = true;
        land.gain_max = std::max(land.gain_max, largest_gain(*memory->fields[i], in.area));
        for (const size_t train : in.bands[i].trains) field_of_train[train] = memory->fields[i]->id();
    }
    take_growth(land, in, growths);
    if (any) land.field_of_train = std::move(field_of_train);
    land.memory = std::move(memory);
}

}  // namespace

TracedLand retrace_land(const WaveTrainBox& successor, const TracedLand& old, const TerrainGrid& before,
                        const TerrainGrid& after, const LatticeRect& changed, FieldId first_field,
                        const LandSettings& settings, RetraceStats* stats) {
    TROCHOID_ASSERT(land_settings_fault(settings) == nullptr, "{}", land_settings_fault(settings));
    TROCHOID_ASSERT(terrain_fault(after) == nullptr, "{}", terrain_fault(after));
    const TraceInput in = trace_input(successor, after, settings, false);
    RetraceStats sum;
    sum.bands = static_cast<uint32_t>(in.bands.size());
    TracedLand land;
    if (in.bands.empty() || in.area.empty() || !old.memory || !fits(*old.memory, in)) {
        LandTraceStats whole;
        land = trace_land(successor, after, first_field, settings, &whole);
        sum.whole = true;
        sum.bands_traced = sum.bands;
        sum.bands_changed = static_cast<uint32_t>(land.fields.size());
        sum.rows = sum.rows_marched = whole.rows_marched;
        sum.blocks_compared = sum.blocks_changed = whole.blocks;
        sum.rays = sum.rays_walked = land.rays.size();
        if (stats != nullptr) *stats = sum;
        return land;
    }
    const LatticeRect reach = reach_of(after, changed);
    const std::vector<ChangedNode> nodes = changed_nodes(in, before, reach);
    RayReuse reuse{old.rays, reach, 0};
    land.rays = wave_rays(successor, after, dominant_band(in.bands), settings, &reuse);
    std::vector<BandChange> changes(in.bands.size());
    for_each_band(in.bands.size(), settings.threads, [&](size_t i, TraceWorkspace& work) {
        changes[i] = retrace_band(in, i, *old.memory, nodes, work);
    });
    sum.changed_nodes = nodes.size();
    sum.rows = whole_rows(in);
    for (const BandChange& change : changes) {
        sum.bands_traced += change.traced ? 1U : 0U;
        sum.bands_changed += change.blocks.empty() ? 0U : 1U;
        sum.rows_marched += change.rows_marched;
        sum.blocks_compared += change.compared;
        sum.blocks_changed += change.blocks.size();
    }
    sum.rays = land.rays.size();
    sum.rays_walked = reuse.walked;
    take_changes(land, in, *old.memory, changes, first_field);
    if (stats != nullptr) *stats = sum;
    return land;
}

}  // namespace trochoid
