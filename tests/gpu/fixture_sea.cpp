#include "tests/gpu/fixture_sea.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <fstream>
#include <iterator>
#include <set>

#include "client/scene/sea_mesh.hpp"
#include "protocol/model/displayed.hpp"
#include "protocol/model/terrain_file.hpp"

namespace trochoid {

namespace {

constexpr double two_pi = 6.283185307179586;

double spread(uint32_t& state) {
    state = state * 1664525U + 1013904223U;
    return (state >> 8) / 16777216.0;
}

PatchDescriptor describe(PatchKey key, const InterestState& state) {
    PatchDescriptor patch;
    patch.key = key;
    for (const auto& [id, box] : state.boxes)
        if (overlap(bounds_of(*box),
                    {corner_of(key), {corner_of(key).x + side_of(key), corner_of(key).z + side_of(key)}}))
            patch.boxes.push_back({id, static_cast<uint16_t>(box->trains.size())});
    return patch;
}

double nearest(PatchKey key, LatticePoint p) {
    const LatticePoint c = corner_of(key);
    const int64_t s = side_of(key);
    const int64_t dx = std::max<int64_t>({c.x - p.x, p.x - c.x - s, 0});
    const int64_t dz = std::max<int64_t>({c.z - p.z, p.z - c.z - s, 0});
    return std::hypot(to_metres(dx), to_metres(dz));
}

std::vector<PatchKey> children_of(PatchKey key) {
    std::vector<PatchKey> four;
    four.reserve(4);
    for (int i = 0; i < 4; ++i)
        four.push_back({static_cast<uint8_t>(key.level - 1), key.x * 2 + (i & 1), key.z * 2 + (i >> 1)});
    return four;
}

/// Splits leaves until no neighbour is more than one level coarser.
void balance(std::set<PatchKey>& leaves) {
    std::deque<PatchKey> open(leaves.begin(), leaves.end());
    while (!open.empty()) {
        const PatchKey key = open.front();
        open.pop_front();
        if (!leaves.contains(key)) continue;
        for (const auto& [dx, dz] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
            for (int up = 2; key.level + up <= coarsest_patch_level; ++up) {
                const PatchKey coarse{static_cast<uint8_t>(key.level + up), (key.x + dx) >> up,
                                      (key.z + dz) >> up};
                if (!leaves.contains(coarse)) continue;
                leaves.erase(coarse);
                for (const PatchKey child : children_of(coarse)) {
                    leaves.insert(child);
                    open.push_back(child);
                }
                open.push_back(key);
            }
    }
}

}  // namespace

WaveTrain deep_train(double wavelength, double heading, float amplitude, float choppiness, uint32_t phase) {
    WaveTrain train;
    const double turns = 4294967296.0 / (wavelength * 1024.0);
    train.kx = static_cast<int32_t>(std::lround(turns * std::cos(heading)));
    train.kz = static_cast<int32_t>(std::lround(turns * std::sin(heading)));
    const double omega = std::sqrt(9.81 * two_pi / wavelength);
    train.omega = static_cast<uint64_t>(omega / two_pi * 1e-6 * 18446744073709551616.0);
    train.phase = phase;
    train.amplitude = amplitude;
    train.choppiness = choppiness;
    return train;
}

std::vector<WaveTrain> wind_sea(double peak_wavelength, double heading, double significant_height, int count,
                                uint32_t seed) {
    std::vector<WaveTrain> trains;
    double energy = 0;
    for (int i = 0; i < count; ++i) {
        const double wavelength =
            peak_wavelength * 1.5 * std::pow(3.0 / (peak_wavelength * 1.5), (i + 0.5 * spread(seed)) / count);
        const double ratio = wavelength / peak_wavelength;
        // Pierson and Moskowitz over equal steps of log k: E ~ k^-2 exp(-1.25 (k_p / k)^-2).
        const double share = ratio * ratio * std::exp(-1.25 * ratio * ratio);
        const double turn = (spread(seed) + spread(seed) - 1.0) * 1.0;
        trains.push_back(deep_train(wavelength, heading + turn, static_cast<float>(std::sqrt(share)), 0.8F,
                                    static_cast<uint32_t>(spread(seed) * 4294967295.0)));
        energy += share / 2;
    }
    const auto scale = static_cast<float>(significant_height / 4.0 / std::sqrt(energy));
    for (WaveTrain& train : trains) train.amplitude *= scale;
    return trains;
}

std::vector<PatchKey> ring_of_patches(LatticePoint centre, double altitude_m, double reach_m,
                                      double angle_per_vertex) {
    std::set<PatchKey> leaves;
    std::deque<PatchKey> open;
    const int root = 22;
    for (int32_t z = -3; z <= 2; ++z)
        for (int32_t x = -3; x <= 2; ++x)
            open.push_back({root, static_cast<int32_t>((centre.x + (int64_t{1} << 21)) >> root) + x,
                            static_cast<int32_t>((centre.z + (int64_t{1} << 21)) >> root) + z});
    while (!open.empty()) {
        const PatchKey key = open.front();
        open.pop_front();
        const double away = nearest(key, centre);
        if (away > reach_m) continue;
        const double distance = std::hypot(away, altitude_m);
        const double spacing = std::max(distance * angle_per_vertex, 0.5);
        if (key.level > finest_patch_level && to_metres(side_of(key)) / spacing > patch_segments)
            for (const PatchKey child : children_of(key)) open.push_back(child);
        else
            leaves.insert(key);
    }
    balance(leaves);
    return {leaves.begin(), leaves.end()};
}

std::vector<FieldBlock> shore_field(FieldId id, const TerrainGrid& grid, uint8_t step_log2) {
    std::vector<FieldBlock> blocks;
    const int64_t side = int64_t{block_cells} << step_log2;
    const int64_t span = (int64_t{grid.columns} - 1) << grid.spacing_log2;
    for (int64_t bz = grid.origin_z / side - 1; bz * side < grid.origin_z + span; ++bz)
        for (int64_t bx = grid.origin_x / side - 1; bx * side < grid.origin_x + span; ++bx) {
            auto block = std::make_shared<LandBlock>();
            block->key = {static_cast<int32_t>(bx), static_cast<int32_t>(bz)};
            for (int j = 0; j < block_nodes; ++j)
                for (int i = 0; i < block_nodes; ++i) {
                    const int64_t x = bx * side + (int64_t{i} << step_log2);
                    const int64_t z = bz * side + (int64_t{j} << step_log2);
                    const double depth = -to_metres(height_at(grid, x, z));
                    const double rise = std::clamp((depth - 0.4) / 4.0, 0.0, 1.0);
                    const double gain = rise * (1.0 + 0.25 * std::exp(-depth / 8.0));
                    block->gain[static_cast<size_t>(j * block_nodes + i)] =
                        static_cast<uint16_t>(gain * 32768.0);
                    block->shift[static_cast<size_t>(j * block_nodes + i)] =
                        static_cast<int32_t>(65536.0 * 1.5 * std::exp(-std::max(depth, 0.0) / 12.0));
                }
            if (!trivial(*block)) blocks.push_back({id, step_log2, std::move(block)});
        }
    return blocks;
}

FixtureSource::FixtureSource(const TerrainGrid& terrain) {
    if (terrain.columns > 0) {
        extent_ = {terrain.origin_x, terrain.origin_z, terrain.spacing_log2,
                   terrain.columns,  terrain.rows,     terrain.open_sea_depth};
        for (uint32_t level = 0; level < tile_levels(terrain); ++level)
            for (const TerrainTileKey& key : tiles_at_level(terrain, level))
                tiles_.push_back(std::make_shared<const TerrainTile>(make_tile(terrain, key)));
        for (FieldBlock& block : shore_field({1}, terrain, 16))
            state_->blocks[{block.field, block.block->key}] = block;
    }
    WaveTrainBox wind;
    wind.id = {1};
    wind.first_train = {1};
    wind.origin = {to_lattice(-12'000), to_lattice(-9'000)};
    wind.length = to_lattice(26'000);
    wind.width = to_lattice(18'000);
    wind.ramp_rear = wind.ramp_front = wind.ramp_side = static_cast<int32_t>(to_lattice(2'000));
    wind.trains = wind_sea(60.0, 0.15, 1.9, 24, 7);
    for (WaveTrain& train : wind.trains) train.field = {terrain.columns > 0 ? 1U : 0U};
    wind.gain_max = 41'000;
    add_box(wind);
    WaveTrainBox swell;
    swell.id = {2};
    swell.first_train = {100};
    swell.trains = wind_sea(170.0, 0.9, 0.9, 8, 3);
    for (WaveTrain& train : swell.trains) train.field = {terrain.columns > 0 ? 1U : 0U};
    swell.gain_max = 41'000;
    add_box(swell);
}

void FixtureSource::add_box(const WaveTrainBox& box) {
    auto next = std::make_shared<InterestState>(*state_);
    next->boxes[box.id] = std::make_shared<const WaveTrainBox>(box);
    for (auto& [key, patch] : next->patches) patch = describe(key, *next);
    state_ = std::move(next);
}

void FixtureSource::remake_patches(LatticePoint centre, double altitude_m, double angle_per_vertex) {
    auto next = std::make_shared<InterestState>(*state_);
    next->patches.clear();
    for (const PatchKey key : ring_of_patches(centre, altitude_m, 13'000, angle_per_vertex))
        next->patches[key] = describe(key, *next);
    state_ = std::move(next);
}

SceneInput FixtureSource::snapshot() {
    SceneInput input;
    input.state = state_;
    input.now = now_;
    input.terrain = extent_;
    input.tiles = tiles_;
    input.rays = rays_;
    input.statistics.connected = true;
    input.statistics.state = "fixture";
    input.statistics.server_version = "fixture";
    input.statistics.fidelity = Fidelity::exact;
    return input;
}

void FixtureSource::set_view(const ViewState& view) {
    const double moved = std::hypot(to_metres(view.position.x - viewed_.position.x),
                                    to_metres(view.position.z - viewed_.position.z));
    if (placed_ && moved < 50.0) return;
    viewed_ = view;
    placed_ = true;
    remake_patches(view.position, to_metres(view.altitude),
                   display_filter(view, view.accepted_error_px).angle_per_vertex);
}

void FixtureSource::request_rays(BoxId box) {
    if (!rays_.empty() || box.value != 1) return;
    for (int i = 0; i < 60; ++i) {
        WaveRay ray;
        ray.start = {to_lattice(-12'000), to_lattice(-8'500 + 290 * i)};
        ray.end = {to_lattice(13'000), to_lattice(-8'500 + 290 * i + 3'700)};
        for (int k = 1; k <= 4; ++k)
            ray.points.push_back({{ray.start.x + (ray.end.x - ray.start.x) * k / 5,
                                   ray.start.z + (ray.end.z - ray.start.z) * k / 5},
                                  static_cast<ActionKind>(k)});
        rays_.push_back(ray);
    }
}

TerrainGrid shipped_terrain() {
    std::ifstream file(TROCHOID_SOURCE_DIR "/server/scenes/scilly/scilly.terrain", std::ios::binary);
    const std::vector<uint8_t> bytes((std::istreambuf_iterator<char>(file)),
                                     std::istreambuf_iterator<char>());
    auto grid = decode_terrain(bytes);
    return grid ? *grid : TerrainGrid{};
}

}  // namespace trochoid
