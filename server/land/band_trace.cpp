#include "server/land/band_trace.hpp"

#include <algorithm>
#include <atomic>
#include <thread>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/depth_table.hpp"
#include "server/land/finite_depth.hpp"
#include "server/land/turning.hpp"
#include "server/world/steepness.hpp"

namespace trochoid {

namespace {

/// However flat its waves are in the open sea, no land makes a box's steeper than this.
constexpr double growth_most = 32.0;

/// How much steeper than on open water the land may make the box's waves before they break.
double growth_allowed(const std::vector<WaveBand>& bands, const LandSettings& settings) {
    double steepness = 0.0;
    for (const WaveBand& band : bands) steepness = steepness + two_pi_f64 * band.steepness;
    const double least = settings.steepness_max / growth_most;
    return std::max(expected_land_growth, settings.steepness_max / std::max(steepness, least));
}

/// What a band would grow at the depth where the box's waves break.
double growth_where_breaking(const DepthResponse& response, double height, const LandSettings& settings) {
    const double breaking = settings.breaking_ratio > 0.0 ? height / settings.breaking_ratio : 0.0;
    const double depth = std::max(settings.depth_min, breaking);
    return std::max(response.wave_number(depth) * response.growth(depth), 1.0);
}

/// Tiles of nodes that the marked blocks have nodes in.
std::vector<uint8_t> tiles_of_blocks(const LandArea& area, std::span<const uint8_t> blocks) {
    TileMarks nodes;
    nodes.reset(area.nodes_x(), area.nodes_z());
    size_t at = 0;
    for (int32_t bz = 0; bz < area.blocks_z; ++bz)
        for (int32_t bx = 0; bx < area.blocks_x; ++bx, ++at)
            if (blocks[at] != 0)
                for (const int32_t z : {bz, bz + 1})
                    for (const int32_t x : {bx, bx + 1}) nodes.add(x * block_cells, z * block_cells, 1);
    return {nodes.tiles().begin(), nodes.tiles().end()};
}

/// Marks the blocks of a row that are not open water; of a restart only those `looked_at`.
void mark_live(const BandView& view, TraceWorkspace& work, std::span<const uint8_t> looked_at, int32_t bz) {
    const LandArea& area = *view.area;
    size_t at = static_cast<size_t>(bz) * static_cast<size_t>(area.blocks_x);
    for (int32_t bx = 0; bx < area.blocks_x; ++bx, ++at) {
        if (view.touching[at] == 0 || (!looked_at.empty() && looked_at[at] == 0)) continue;
        if (!block_is_open(area, work.field, bx, bz)) work.live[at] = 1;
    }
}

/// First and last tile that [least, most] touches on a grid of `tiles`; none: first > last.
struct TileSpan {
    int32_t first;
    int32_t last;
};
TileSpan tiles_touched(double least, double most, size_t tiles) {
    const auto count = static_cast<int32_t>(tiles);
    const auto tile_of = [&](double at) {
        return static_cast<int32_t>(std::clamp(at / TileMarks::side, 0.0, static_cast<double>(count)));
    };
    if (most < 0.0) return {0, -1};
    return {tile_of(least), std::min(tile_of(most), count - 1)};
}

/// Whether a block's nodes lie in tiles of the march that have changed.
bool march_changed(const BandGrid& grid, std::span<const uint64_t> before, int32_t bx, int32_t bz) {
    const size_t across = tiles_across(grid);
    double least_row = 0x1p40;
    double most_row = -0x1p40;
    double least_column = 0x1p40;
    double most_column = -0x1p40;
    for (const int32_t z : {bz, bz + 1})
        for (const int32_t x : {bx, bx + 1}) {
            const double row = grid.row_of(x * block_cells, z * block_cells);
            const double column = grid.column_of(x * block_cells, z * block_cells);
            least_row = std::min(least_row, row);
            most_row = std::max(most_row, row);
            least_column = std::min(least_column, column);
            most_column = std::max(most_column, column);
        }
    // The cells around the nodes, and roundings.
    const TileSpan rows = tiles_touched(least_row - 1.5, most_row + 1.5, before.size() / across);
    const TileSpan columns = tiles_touched(least_column - 1.5, most_column + 1.5, across);
    for (int32_t row = rows.first; row <= rows.last; ++row)
        for (int32_t column = columns.first; column <= columns.last; ++column) {
            const size_t tile = static_cast<size_t>(row) * across + static_cast<size_t>(column);
            if (grid.tile_hashes[tile] != before[tile]) return true;
        }
    return false;
}

/// What a restart has to look at.
struct RestartBlocks {
    /// Blocks that may have changed.
    std::vector<uint8_t> decided;
    /// These and their neighbours, whose cells say how the nodes between are limited.
    std::vector<uint8_t> looked_at;
    /// Tiles of the nodes of those.
    std::vector<uint8_t> tiles;
};

RestartBlocks restart_blocks(const BandView& view, const BandGrid& grid, const BandRestart& restart) {
    const LandArea& area = *view.area;
    const bool known = restart.tile_hashes.size() == grid.tile_hashes.size();
    TileMarks blocks;
    blocks.reset(area.nodes_x() - 1, area.nodes_z() - 1);
    const std::span<uint8_t> marks = blocks.tiles();
    size_t at = 0;
    for (int32_t bz = 0; bz < area.blocks_z; ++bz)
        for (int32_t bx = 0; bx < area.blocks_x; ++bx, ++at)
            marks[at] = !known || restart.blocks[at] != 0 || march_changed(grid, restart.tile_hashes, bx, bz);
    RestartBlocks out;
    blocks.spread(1);
    out.decided.assign(marks.begin(), marks.end());
    blocks.spread(1);
    out.looked_at.assign(marks.begin(), marks.end());
    for (size_t block = 0; block < out.looked_at.size(); ++block)
        if (view.touching[block] == 0) marks[block] = 0;
    out.tiles = tiles_of_blocks(area, marks);
    return out;
}

/// Rows of nodes that a march feels from its row `row` on.
NodeRows rows_felt(const LandArea& area, const BandGrid& grid, int32_t row) {
    const double along = static_cast<double>(row) * grid.row_step - grid.centre_row +
                         grid.centre_x * grid.dx + grid.centre_z * grid.dz;
    const double farthest = std::max(static_cast<double>(area.nodes_x() - 1) * grid.dx, 0.0);
    const double last = static_cast<double>(area.nodes_z());
    const double z = std::clamp((along - farthest) / grid.dz, 0.0, last);
    const auto whole = static_cast<int32_t>(z);
    if (grid.dz > 0.0) return {std::max(whole - 3, 0), area.nodes_z()};
    return {0, std::min(whole + 4, area.nodes_z())};
}

bool travels_along_x(const WaveBand& band) { return band.dx * band.dx > band.dz * band.dz; }

LandArea turned(const LandArea& area) {
    LandArea out = area;
    std::swap(out.first.x, out.first.z);
    std::swap(out.blocks_x, out.blocks_z);
    std::swap(out.belt_min_x, out.belt_min_z);
    std::swap(out.belt_max_x, out.belt_max_z);
    for (size_t i = 0; i < out.corners.size(); i += 2) std::swap(out.corners[i], out.corners[i + 1]);
    return out;
}

void take_touching(TraceInput& in) {
    for (int32_t bz = 0; bz < in.area.blocks_z; ++bz)
        for (int32_t bx = 0; bx < in.area.blocks_x; ++bx)
            in.touching.push_back(block_touches(in.area, bx, bz, in.box) ? 1 : 0);
    in.touching_tiles = tiles_of_blocks(in.area, in.touching);
}

}  // namespace

TraceInput trace_input(const WaveTrainBox& box, const TerrainGrid& terrain, const LandSettings& settings,
                       bool with_stats) {
    TraceInput in{.box = box, .settings = settings};
    in.with_stats = with_stats;
    in.area = land_area(box, terrain, settings);
    in.bands = wave_bands(box);
    if (in.area.empty() || in.bands.empty()) return in;
    in.depths = node_depths(in.area, box, terrain, settings.run_up);
    in.tile_depths = tile_minima(in.depths, in.area.nodes_x(), in.area.nodes_z());
    take_touching(in);
    in.least_depth = *std::min_element(in.tile_depths.begin(), in.tile_depths.end());
    if (std::any_of(in.bands.begin(), in.bands.end(), travels_along_x)) {
        in.turned_area = turned(in.area);
        in.turned_depths =
            turned(in.depths, static_cast<size_t>(in.area.nodes_x()), static_cast<size_t>(in.area.nodes_z()));
        in.turned_tile_depths =
            tile_minima(in.turned_depths, in.turned_area.nodes_x(), in.turned_area.nodes_z());
        const auto blocks_x = static_cast<size_t>(in.area.blocks_x);
        for (size_t bx = 0; bx < blocks_x; ++bx)
            for (size_t at = bx; at < in.touching.size(); at += blocks_x)
                in.turned_touching.push_back(in.touching[at]);
        in.turned_touching_tiles = tiles_of_blocks(in.turned_area, in.turned_touching);
    }
    in.open_depth = to_metres(-int64_t{terrain.open_sea_depth}) + settings.run_up;
    in.height = significant_height(box);
    std::vector<double> unlimited;
    for (const WaveBand& band : in.bands)
        unlimited.push_back(growth_where_breaking(response_of(in, band), in.height, settings));
    in.allowed = growth_allowances(in.bands, unlimited, growth_allowed(in.bands, settings));
    return in;
}

DepthResponse response_of(const TraceInput& in, const WaveBand& band) {
    return DepthResponse(band.turns_per_metre, in.open_depth, in.height, in.settings);
}

BandView TraceInput::view(size_t index) const {
    if (!travels_along_x(bands[index]))
        return {false, bands[index], &area, depths, tile_depths, touching, touching_tiles};
    BandView view{true,
                  bands[index],
                  &turned_area,
                  turned_depths,
                  turned_tile_depths,
                  turned_touching,
                  turned_touching_tiles};
    std::swap(view.band.dx, view.band.dz);
    return view;
}

void copy_block_of(LandBlock& block, const TraceInput& in, const BandView& view, const NodeField& field,
                   int32_t bx, int32_t bz) {
    const BlockOffset at = block_in_area(view, bx, bz);
    copy_block(block, *view.area, field, at.x, at.z, view.turned);
    block.key = {in.area.first.x + bx, in.area.first.z + bz};
}

bool block_of_is_open(const BandView& view, const NodeField& field, int32_t bx, int32_t bz) {
    const BlockOffset at = block_in_area(view, bx, bz);
    return block_is_open(*view.area, field, at.x, at.z);
}

BandOutcome trace_band(const TraceInput& in, size_t index, TraceWorkspace& work, const BandRestart* restart) {
    BandOutcome out;
    out.memory = std::make_shared<BandMemory>();
    work.live.clear();
    const BandView view = in.view(index);
    const LandArea& area = *view.area;
    const DepthResponse response = response_of(in, view.band);
    if (in.least_depth >= static_cast<float>(response.untouched())) return out;
    const DepthTable table(response);
    set_frame(work.grid, area, view.band, in.settings);
    const bool resumes = restart != nullptr && !restart->checkpoints.empty();
    NodeRows felt{0, area.nodes_z()};
    if (resumes) felt = rows_felt(area, work.grid, restart->checkpoints.back().row);
    fill_node_planes(work.planes, area, view.depths, view.tile_depths, felt, view.band, table,
                     in.settings.refraction == Refraction::straight);
    if (!work.planes.touched && !resumes) return out;
    if (resumes) {
        out.memory->checkpoints = restart->checkpoints;
        work.grid.tile_hashes.assign(restart->tile_hashes.begin(), restart->tile_hashes.end());
    }
    march_band(work.grid, area, work.planes, view.band, response, in.settings, out.memory->checkpoints);
    if (!work.grid.held) return out;
    RestartBlocks blocks;
    if (restart != nullptr) blocks = restart_blocks(view, work.grid, *restart);
    work.live.assign(static_cast<size_t>(area.blocks_x) * static_cast<size_t>(area.blocks_z), 0);
    GrowthLimit limit(work.field, area, work.live, view.band, in.allowed[index]);
    fill_node_field(work.field, area, view.depths, view.tile_depths,
                    restart != nullptr ? std::span<const uint8_t>(blocks.tiles) : view.touching_tiles,
                    work.grid, table, in.settings, [&](int32_t bz) {
                        mark_live(view, work, blocks.looked_at, bz);
                        limit.measure(bz);
                    });
    out.growth = limit.limited();
    out.memory->tile_hashes = work.grid.tile_hashes;
    out.decided = std::move(blocks.decided);
    out.touched = true;
    return out;
}

void take_growth(TracedLand& land, const TraceInput& in, const std::vector<float>& growths) {
    double sum = 0.0;
    double weights = 0.0;
    double most = 1.0;
    for (size_t i = 0; i < in.bands.size(); ++i) {
        const auto growth = static_cast<double>(growths[i]);
        sum = sum + in.bands[i].steepness * growth;
        weights = weights + in.bands[i].steepness;
        most = std::max(most, growth);
    }
    // One part in 10^5 covers the roundings of the cells' float32.
    const double mean = weights > 0.0 ? std::max(sum / weights, 1.0) : 1.0;
    land.steepness_growth = mean > 1.0 ? static_cast<float>(mean * 1.00001) : 1.0F;
    land.steepness_growth_most = most > 1.0 ? static_cast<float>(most * 1.00001) : 1.0F;
}

void for_each_band(size_t count, uint32_t threads, const std::function<void(size_t, TraceWorkspace&)>& work) {
    std::atomic<size_t> next{0};
    const auto run = [&] {
        TraceWorkspace space;
        for (size_t i = next++; i < count; i = next++) work(i, space);
    };
    const size_t wanted = threads != 0 ? threads : std::max(std::thread::hardware_concurrency(), 1U);
    std::vector<std::jthread> others;
    for (size_t i = 1; i < std::min(wanted, count); ++i) others.emplace_back(run);
    run();
}

}  // namespace trochoid
