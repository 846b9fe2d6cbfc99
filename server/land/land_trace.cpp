#include "server/land/land_trace.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"
#include "server/land/band_trace.hpp"
#include "server/land/ray_trace.hpp"

namespace trochoid {

namespace {

/// One band's outcome, before it has an id.
struct BandResult {
    std::vector<std::shared_ptr<const LandBlock>> blocks;
    std::shared_ptr<const BandMemory> memory;
    float growth = 1.0F;
    uint16_t gain_max = unit_node_gain;
    LandTraceStats stats;
};

double turns_between(int32_t a, int32_t b) {
    const int64_t difference = int64_t{a} - b;
    return static_cast<double>(difference < 0 ? -difference : difference) * 0x1p-16;
}

/// How well nodes carry the shift, along one axis of three neighbouring nodes.
void measure(const NodeField& field, size_t n, size_t next, LandTraceStats& stats) {
    constexpr uint16_t live = unit_node_gain / 10;
    if (field.gain[n] < live || field.gain[n + next] < live || field.gain[n + 2 * next] < live) return;
    const int32_t a = field.shift[n];
    const int32_t b = field.shift[n + next];
    const int32_t c = field.shift[n + 2 * next];
    const double bend = turns_between(b - a, c - b);
    stats.largest_step = std::max(stats.largest_step, turns_between(a, b));
    stats.largest_bend = std::max(stats.largest_bend, bend);
    ++stats.live_cells;
    if (bend > 0.5) ++stats.bent_cells;
}

/// Over the live blocks of a view; between blocks nothing is measured.
void measure_nodes(const LandArea& area, const TraceWorkspace& work, LandTraceStats& stats) {
    const auto nx = static_cast<size_t>(area.nodes_x());
    size_t at = 0;
    for (int32_t bz = 0; bz < area.blocks_z; ++bz) {
        for (int32_t bx = 0; bx < area.blocks_x; ++bx, ++at) {
            if (work.live[at] == 0) continue;
            for (size_t z = 0; z < block_nodes; ++z) {
                for (size_t x = 0; x < block_nodes; ++x) {
                    const size_t n = block_start(area, bx, bz) + z * nx + x;
                    if (x + 2 < block_nodes) measure(work.field, n, 1, stats);
                    if (z + 2 < block_nodes) measure(work.field, n, nx, stats);
                }
            }
        }
    }
}

void add(LandTraceStats& sum, const LandTraceStats& band) {
    sum.cut_slopes += band.cut_slopes;
    sum.limited_cells += band.limited_cells;
    sum.rows_marched += band.rows_marched;
    sum.ray_steps += band.ray_steps;
    sum.largest_step = std::max(sum.largest_step, band.largest_step);
    sum.largest_bend = std::max(sum.largest_bend, band.largest_bend);
    sum.bent_cells += band.bent_cells;
    sum.live_cells += band.live_cells;
}

void take_blocks(BandResult& result, const TraceInput& in, const BandView& view, const TraceWorkspace& work) {
    // One for all: new memory is then written once.
    LandBlock taken;
    for (int32_t bz = 0; bz < in.area.blocks_z; ++bz) {
        for (int32_t bx = 0; bx < in.area.blocks_x; ++bx) {
            if (work.live[block_index(view, bx, bz)] == 0 || block_of_is_open(view, work.field, bx, bz))
                continue;
            copy_block_of(taken, in, view, work.field, bx, bz);
            result.gain_max = std::max(result.gain_max, largest_gain(taken));
            result.blocks.push_back(std::make_shared<const LandBlock>(taken));
        }
    }
}

BandResult whole_band(const TraceInput& in, size_t index, TraceWorkspace& work) {
    BandResult result;
    BandOutcome outcome = trace_band(in, index, work, nullptr);
    if (outcome.touched) {
        const BandView view = in.view(index);
        take_blocks(result, in, view, work);
        for (const float square : outcome.growth.squared)
            result.growth = std::max(result.growth, std::sqrt(square));
        if (in.with_stats) measure_nodes(*view.area, work, result.stats);
        result.stats.cut_slopes = work.grid.cut_slopes;
        result.stats.limited_cells = outcome.growth.limited_cells;
        result.stats.rows_marched = work.grid.rows_marched;
        result.stats.ray_steps = work.grid.rows_marched * static_cast<uint64_t>(work.grid.columns);
        outcome.memory->growth = std::move(outcome.growth.squared);
    }
    result.memory = std::move(outcome.memory);
    return result;
}

/// Bands with blocks become fields, in order.
void take_fields(TracedLand& land, LandMemory& memory, const TraceInput& in, std::vector<BandResult>& results,
                 FieldId first_field) {
    std::vector<FieldId> field_of_train(in.box.trains.size());
    std::vector<float> growths;
    for (size_t i = 0; i < results.size(); ++i) {
        BandResult& result = results[i];
        growths.push_back(result.growth);
        memory.marches.push_back(std::move(result.memory));
        memory.fields.emplace_back();
        if (result.blocks.empty()) continue;
        const FieldId id{first_field.value + static_cast<uint32_t>(land.fields.size())};
        land.fields.push_back(make_land_field(id, in.area.step_log2, result.blocks));
        memory.fields.back() = land.fields.back();
        for (const size_t train : in.bands[i].trains) field_of_train[train] = id;
        land.gain_max = std::max(land.gain_max, result.gain_max);
    }
    take_growth(land, in, growths);
    if (!land.fields.empty()) land.field_of_train = std::move(field_of_train);
}

}  // namespace

const WaveBand& dominant_band(const std::vector<WaveBand>& bands) {
    return *std::max_element(bands.begin(), bands.end(),
                             [](const WaveBand& a, const WaveBand& b) { return a.variance < b.variance; });
}

std::shared_ptr<LandField> make_land_field(FieldId id, uint8_t step_log2,
                                           std::span<const std::shared_ptr<const LandBlock>> blocks) {
    auto field = std::make_shared<LandField>(id, step_log2);
    // The far corners first: the field then lays out its window once.
    if (!blocks.empty()) {
        const auto by_x = [](const auto& a, const auto& b) { return a->key.x < b->key.x; };
        const auto [west, east] = std::minmax_element(blocks.begin(), blocks.end(), by_x);
        for (const auto& block : {*west, *east, blocks.front(), blocks.back()}) field->set(block);
    }
    for (const auto& block : blocks) field->set(block);
    return field;
}

TracedLand trace_land(const WaveTrainBox& box, const TerrainGrid& terrain, FieldId first_field,
                      const LandSettings& settings, LandTraceStats* stats) {
    TROCHOID_ASSERT(land_settings_fault(settings) == nullptr, "{}", land_settings_fault(settings));
    TROCHOID_ASSERT(terrain_fault(terrain) == nullptr, "{}", terrain_fault(terrain));
    const TraceInput in = trace_input(box, terrain, settings, stats != nullptr);
    TracedLand land;
    if (in.bands.empty()) return land;
    land.rays = wave_rays(box, terrain, dominant_band(in.bands), settings);
    LandTraceStats sum;
    sum.step_log2 = in.area.step_log2;
    sum.bands = static_cast<uint32_t>(in.bands.size());
    auto memory = std::make_shared<LandMemory>();
    memory->area = in.area;
    memory->settings = settings;
    memory->height = in.height;
    memory->bands = in.bands;
    if (in.area.empty()) {
        memory->marches.assign(in.bands.size(), std::make_shared<BandMemory>());
        memory->fields.resize(in.bands.size());
    } else {
        sum.nodes_per_band = in.area.nodes();
        std::vector<BandResult> results(in.bands.size());
        for_each_band(in.bands.size(), settings.threads,
                      [&](size_t i, TraceWorkspace& work) { results[i] = whole_band(in, i, work); });
        for (const BandResult& result : results) add(sum, result.stats);
        take_fields(land, *memory, in, results, first_field);
        for (const auto& field : land.fields) sum.blocks += field->block_count();
    }
    land.memory = std::move(memory);
    if (stats != nullptr) *stats = sum;
    return land;
}

TracedLand with_first_field(const TracedLand& land, FieldId first_field) {
    if (land.fields.empty() || land.fields.front()->id() == first_field) return land;
    const uint32_t old_first = land.fields.front()->id().value;
    const auto renamed = [&](FieldId id) {
        return id.value < old_first ? id : FieldId{first_field.value + (id.value - old_first)};
    };
    TracedLand out = land;
    for (auto& field : out.fields) {
        const auto same = make_land_field(renamed(field->id()), field->step_log2(), field->blocks());
        same->set_base(field->base());
        field = same;
    }
    for (FieldOverlay& overlay : out.overlays) overlay.field = renamed(overlay.field);
    for (FieldId& id : out.field_of_train) id = renamed(id);
    if (land.memory) {
        auto memory = std::make_shared<LandMemory>(*land.memory);
        for (auto& field : memory->fields)
            if (field && field->id().value >= old_first) field = out.fields[field->id().value - old_first];
        out.memory = std::move(memory);
    }
    return out;
}

uint64_t hash_of(const TracedLand& land) {
    Hash64 hash;
    for (const auto& field : land.fields) {
        hash.u32(field->id().value).u8(field->step_log2());
        for (const auto& block : field->blocks()) {
            hash.i32(block->key.x).i32(block->key.z);
            for (const int32_t shift : block->shift) hash.i32(shift);
            for (const uint16_t gain : block->gain) hash.u16(gain);
            for (const uint16_t orbit : block->orbit) hash.u16(orbit);
        }
    }
    for (const FieldId id : land.field_of_train) hash.u32(id.value);
    for (const FieldOverlay& overlay : land.overlays) hash.u32(overlay.field.value).u32(overlay.base.value);
    hash.u16(land.gain_max).f32(land.steepness_growth).f32(land.steepness_growth_most);
    for (const WaveRay& ray : land.rays) {
        hash.i64(ray.start.x).i64(ray.start.z).i64(ray.end.x).i64(ray.end.z).u64(ray.points.size());
        for (const ActionPoint& point : ray.points)
            hash.i64(point.at.x).i64(point.at.z).u8(static_cast<uint8_t>(point.kind));
    }
    return hash.value();
}

}  // namespace trochoid
