#include "server/land/land_trace.hpp"

#include <algorithm>
#include <atomic>
#include <thread>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"
#include "server/land/band_march.hpp"
#include "server/land/depth_response.hpp"
#include "server/land/finite_depth.hpp"
#include "server/land/growth_limit.hpp"
#include "server/land/land_area.hpp"
#include "server/land/node_field.hpp"
#include "server/land/ray_trace.hpp"
#include "server/land/wave_bands.hpp"
#include "server/world/steepness.hpp"

namespace trochoid {

namespace {

/// However flat its waves are in the open sea, no land makes a box's steeper than this.
constexpr double growth_most = 8.0;

/// One band's outcome, before it has an id.
struct BandResult {
    std::vector<std::shared_ptr<LandBlock>> blocks;
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

void measure_nodes(const LandArea& area, const NodeField& field, LandTraceStats& stats) {
    const auto nx = static_cast<size_t>(area.nodes_x());
    const auto nz = static_cast<size_t>(area.nodes_z());
    for (size_t z = 0; z < nz; ++z) {
        for (size_t x = 0; x < nx; ++x) {
            const size_t n = z * nx + x;
            if (x + 2 < nx) measure(field, n, 1, stats);
            if (z + 2 < nz) measure(field, n, nx, stats);
        }
    }
}

void add(LandTraceStats& sum, const LandTraceStats& band) {
    sum.cut_slopes += band.cut_slopes;
    sum.largest_step = std::max(sum.largest_step, band.largest_step);
    sum.largest_bend = std::max(sum.largest_bend, band.largest_bend);
    sum.bent_cells += band.bent_cells;
    sum.live_cells += band.live_cells;
}

/// All that the bands have in common.
struct TraceInput {
    const WaveTrainBox& box;
    const LandSettings& settings;
    LandArea area;
    std::vector<float> depths;
    double open_depth;
    double height;
    bool with_stats;
};

BandResult trace_band(const TraceInput& in, const WaveBand& band) {
    BandResult result;
    const DepthResponse response(band.turns_per_metre, in.open_depth, in.height, in.settings);
    const BandGrid grid = march_band(in.area, in.depths, band, response, in.settings);
    if (grid.shift.empty()) return result;
    const NodeField field = node_field(in.area, in.depths, grid, response, in.settings);
    result.blocks = cut_blocks(in.area, field, in.box);
    if (in.with_stats) measure_nodes(in.area, field, result.stats);
    result.stats.cut_slopes = grid.cut_slopes;
    return result;
}

/// Every band on its own: which thread traces which changes nothing.
std::vector<BandResult> trace_bands(const TraceInput& in, const std::vector<WaveBand>& bands) {
    std::vector<BandResult> results(bands.size());
    std::atomic<size_t> next{0};
    const auto work = [&] {
        for (size_t i = next++; i < bands.size(); i = next++) results[i] = trace_band(in, bands[i]);
    };
    const size_t wanted =
        in.settings.threads != 0 ? in.settings.threads : std::max(std::thread::hardware_concurrency(), 1U);
    std::vector<std::jthread> others;
    for (size_t i = 1; i < std::min(wanted, bands.size()); ++i) others.emplace_back(work);
    work();
    others.clear();
    return results;
}

template <class Block>
std::shared_ptr<const LandField> make_field(FieldId id, uint8_t step_log2,
                                            const std::vector<std::shared_ptr<Block>>& blocks) {
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

/// How much steeper than on open water the land may make the box's waves before they break.
double growth_allowed(const std::vector<WaveBand>& bands, const LandSettings& settings) {
    double steepness = 0.0;
    for (const WaveBand& band : bands) steepness = steepness + two_pi_f64 * band.steepness;
    const double least = settings.steepness_max / growth_most;
    return std::max(expected_land_growth, settings.steepness_max / std::max(steepness, least));
}

const WaveBand& dominant(const std::vector<WaveBand>& bands) {
    return *std::max_element(bands.begin(), bands.end(),
                             [](const WaveBand& a, const WaveBand& b) { return a.variance < b.variance; });
}

/// Bands with blocks become fields, in order.
void take_fields(TracedLand& land, const WaveTrainBox& box, const LandArea& area,
                 const std::vector<BandBlocks>& bands, FieldId first_field) {
    std::vector<FieldId> field_of_train(box.trains.size());
    for (const BandBlocks& b : bands) {
        if (b.blocks.empty()) continue;
        const FieldId id{first_field.value + static_cast<uint32_t>(land.fields.size())};
        land.fields.push_back(make_field(id, area.step_log2, b.blocks));
        for (const size_t train : b.band->trains) field_of_train[train] = id;
        for (const auto& block : b.blocks)
            land.gain_max =
                std::max(land.gain_max, *std::max_element(block->gain.begin(), block->gain.end()));
    }
    if (!land.fields.empty()) land.field_of_train = std::move(field_of_train);
}

}  // namespace

TracedLand trace_land(const WaveTrainBox& box, const TerrainGrid& terrain, FieldId first_field,
                      const LandSettings& settings, LandTraceStats* stats) {
    TROCHOID_ASSERT(land_settings_fault(settings) == nullptr, "{}", land_settings_fault(settings));
    TROCHOID_ASSERT(terrain_fault(terrain) == nullptr, "{}", terrain_fault(terrain));
    const std::vector<WaveBand> bands = wave_bands(box);
    TracedLand land;
    if (bands.empty()) return land;
    land.rays = wave_rays(box, terrain, dominant(bands), settings);
    const LandArea area = land_area(box, terrain, settings);
    LandTraceStats sum;
    sum.step_log2 = area.step_log2;
    sum.bands = static_cast<uint32_t>(bands.size());
    if (!area.empty()) {
        sum.nodes_per_band = area.nodes();
        const double open_depth = to_metres(-int64_t{terrain.open_sea_depth});
        const TraceInput in{box,
                            settings,
                            area,
                            node_depths(area, box, terrain),
                            open_depth,
                            significant_height(box),
                            stats != nullptr};
        std::vector<BandResult> results = trace_bands(in, bands);
        for (const BandResult& result : results) add(sum, result.stats);
        std::vector<BandBlocks> blocks;
        for (size_t i = 0; i < bands.size(); ++i) blocks.push_back({&bands[i], std::move(results[i].blocks)});
        const GrowthLimit limit = limit_growth(area, blocks, growth_allowed(bands, settings));
        sum.limited_cells = limit.limited_cells;
        // One part in 10^6 covers the roundings of the sums.
        land.steepness_growth = limit.growth > 1.0 ? static_cast<float>(limit.growth * 1.000001) : 1.0F;
        take_fields(land, box, area, blocks, first_field);
        for (const auto& field : land.fields) sum.blocks += field->block_count();
    }
    if (stats != nullptr) *stats = sum;
    return land;
}

TracedLand renumbered(const TracedLand& land, FieldId first_field) {
    TracedLand out = land;
    const uint32_t old_first = land.fields.empty() ? 0 : land.fields.front()->id().value;
    for (size_t i = 0; i < land.fields.size(); ++i)
        out.fields[i] = make_field({first_field.value + static_cast<uint32_t>(i)},
                                   land.fields[i]->step_log2(), land.fields[i]->blocks());
    for (FieldId& id : out.field_of_train)
        if (id.value != 0) id.value = first_field.value + (id.value - old_first);
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
        }
    }
    for (const FieldId id : land.field_of_train) hash.u32(id.value);
    hash.u16(land.gain_max).f32(land.steepness_growth);
    for (const WaveRay& ray : land.rays) {
        hash.i64(ray.start.x).i64(ray.start.z).i64(ray.end.x).i64(ray.end.z).u64(ray.points.size());
        for (const ActionPoint& point : ray.points)
            hash.i64(point.at.x).i64(point.at.z).u8(static_cast<uint8_t>(point.kind));
    }
    return hash.value();
}

}  // namespace trochoid
