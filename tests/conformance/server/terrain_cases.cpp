#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/conformance/server/refusals.hpp"

// terrain tiles against the grid that the hello describes, and against each other.
namespace trochoid::conformance::server {

namespace {

struct TileOrder {
    bool operator()(const TerrainTileKey& a, const TerrainTileKey& b) const {
        return std::tie(a.level, a.x, a.z) < std::tie(b.level, b.x, b.z);
    }
};
using Tiles = std::map<TerrainTileKey, TerrainTile, TileOrder>;

void check_tile(const TerrainTile& tile, const TerrainInfo& grid) {
    const auto require = [&](bool holds, const char* what) {
        if (!holds)
            throw Failed{
                fmt::format("tile ({}, {}) of level {}: {}", tile.key.x, tile.key.z, tile.key.level, what)};
    };
    const int64_t cells = int64_t{terrain_tile_cells} << tile.key.level;
    require(tile.spacing_log2 == grid.spacing_log2 + tile.key.level,
            "its spacing is not the grid's at its level");
    require(tile.height_step_log2 == grid.height_step_log2, "its height step is not the grid's");
    require(tile.key.x >= 0 && tile.key.z >= 0, "its key is negative");
    require(tile.key.x * cells < int64_t{grid.columns} - 1 && tile.key.z * cells < int64_t{grid.rows} - 1,
            "it does not touch the grid");
    require(tile.origin_x == grid.origin_x + ((tile.key.x * cells) << grid.spacing_log2),
            "its origin's x does not agree with its key");
    require(tile.origin_z == grid.origin_z + ((tile.key.z * cells) << grid.spacing_log2),
            "its origin's z does not agree with its key");
    require(tile.heights.size() == size_t{terrain_tile_samples} * terrain_tile_samples,
            "it has not 65 x 65 heights");
}

int16_t height(const TerrainTile& tile, uint32_t column, uint32_t row) {
    return tile.heights[size_t{row} * terrain_tile_samples + column];
}

/// Tiles of one level beside each other repeat the samples between them. Gives the number of borders compared.
size_t check_borders(const Tiles& tiles) {
    size_t compared = 0;
    const auto equal = [&](const TerrainTile& a, const TerrainTile& b, bool eastwards) {
        for (uint32_t i = 0; i < terrain_tile_samples; ++i) {
            const int16_t mine =
                eastwards ? height(a, terrain_tile_cells, i) : height(a, i, terrain_tile_cells);
            const int16_t theirs = eastwards ? height(b, 0, i) : height(b, i, 0);
            if (mine != theirs)
                throw Failed{fmt::format("tiles ({}, {}) and ({}, {}) of level {} differ on their border",
                                         a.key.x, a.key.z, b.key.x, b.key.z, a.key.level)};
        }
        ++compared;
    };
    for (const auto& [key, tile] : tiles) {
        const auto east = tiles.find({key.level, key.x + 1, key.z});
        const auto south = tiles.find({key.level, key.x, key.z + 1});
        if (east != tiles.end()) equal(tile, east->second, true);
        if (south != tiles.end()) equal(tile, south->second, false);
    }
    return compared;
}

/// Every sample of a coarse tile is one of the finer level's. Gives the number of samples compared.
size_t check_levels(const Tiles& tiles) {
    size_t compared = 0;
    for (const auto& [key, coarse] : tiles) {
        if (key.level == 0) continue;
        for (int part = 0; part < 4; ++part) {
            const auto found =
                tiles.find({static_cast<uint8_t>(key.level - 1), 2 * key.x + part % 2, 2 * key.z + part / 2});
            if (found == tiles.end()) continue;
            for (uint32_t row = 0; row <= terrain_tile_cells; row += 2)
                for (uint32_t column = 0; column <= terrain_tile_cells; column += 2) {
                    const uint32_t c = column / 2 + static_cast<uint32_t>(part % 2) * terrain_tile_cells / 2;
                    const uint32_t r = row / 2 + static_cast<uint32_t>(part / 2) * terrain_tile_cells / 2;
                    if (height(found->second, column, row) != height(coarse, c, r))
                        throw Failed{
                            fmt::format("tile ({}, {}) of level {} is not every second sample of level {}",
                                        key.x, key.z, key.level, key.level - 1)};
                    ++compared;
                }
        }
    }
    return compared;
}

/// All tiles that come for a view from so high, in the order of their coming.
std::vector<TerrainTile> tiles_from(ServerTrial& trial, double altitude_m) {
    if (trial.target().hello.terrain.columns == 0) throw Skipped{"the scene has no terrain"};
    ClientHello hello = ServerPeer::usual_hello();
    hello.view = view_of_water(trial.target(), altitude_m);
    ServerPeer& peer = trial.connect();
    std::vector<TerrainTile> tiles;
    peer.watch([&](const ServerMessage& message, int64_t) {
        if (const auto* some = std::get_if<TerrainTiles>(&message))
            tiles.insert(tiles.end(), some->tiles.begin(), some->tiles.end());
    });
    peer.log_in(hello);
    peer.settle(Milliseconds(400));
    if (tiles.empty()) throw Failed{"the scene has terrain, but no tile came"};
    return tiles;
}

Tiles map_of(const std::vector<TerrainTile>& tiles) {
    Tiles map;
    for (const TerrainTile& tile : tiles) map[tile.key] = tile;
    return map;
}

}  // namespace

void add_terrain_cases(Catalogue& all) {
    for (const double altitude : {50.0, 3000.0}) {
        const std::string name = fmt::format("{:.0f}-m", altitude);
        all.push_back(
            server_case("R-136/tiles-" + name,
                        "Origin, spacing and key of each tile agree with the grid, seen from " + name,
                        [altitude](ServerTrial& trial) {
                            const auto tiles = tiles_from(trial, altitude);
                            for (const TerrainTile& tile : tiles)
                                check_tile(tile, trial.target().hello.terrain);
                            trial.note(fmt::format("{} tiles", tiles.size()));
                        }));
        all.push_back(server_case(
            "R-136/borders-" + name, "Tiles beside each other share their border, seen from " + name,
            [altitude](ServerTrial& trial) {
                trial.note(
                    fmt::format("{} borders compared", check_borders(map_of(tiles_from(trial, altitude)))));
            }));
        all.push_back(server_case(
            "R-136/levels-" + name, "Coarse tiles are every second sample of finer ones, seen from " + name,
            [altitude](ServerTrial& trial) {
                trial.note(
                    fmt::format("{} samples compared", check_levels(map_of(tiles_from(trial, altitude)))));
            }));
    }
    all.push_back(server_case("R-136/once", "No tile comes twice while the land stays as it is",
                              [](ServerTrial& trial) {
                                  const auto tiles = tiles_from(trial, 200.0);
                                  const Tiles apart = map_of(tiles);
                                  for (const TerrainTile& tile : tiles)
                                      if (apart.at(tile.key) != tile)
                                          throw Skipped{"the land was changed meanwhile"};
                                  if (apart.size() != tiles.size())
                                      throw Failed{fmt::format("{} tiles came, {} of them again",
                                                               tiles.size(), tiles.size() - apart.size())};
                              }));
    all.push_back(server_case(
        "R-136/grid", "The grid that the hello describes is one: bounds, steps, counts, projection",
        [](ServerTrial& trial) {
            const ServerHello& hello = trial.log_in().hello();
            const TerrainInfo& grid = hello.terrain;
            if (!std::isfinite(hello.origin_lon) || !std::isfinite(hello.origin_lat))
                throw Failed{"R-116: the origin's degrees are not finite"};
            if (grid.columns == 0) throw Skipped{"the scene has no terrain"};
            if (grid.columns < 2 || grid.rows < 2)
                throw Failed{fmt::format("a grid of {} by {} samples", grid.columns, grid.rows)};
            const int64_t east = grid.origin_x + (int64_t{grid.columns - 1} << grid.spacing_log2);
            const int64_t south = grid.origin_z + (int64_t{grid.rows - 1} << grid.spacing_log2);
            if (!inside_world({grid.origin_x, grid.origin_z}) || !inside_world({east, south}))
                throw Failed{"the grid reaches beyond the world"};
            if (hello.origin_lon < -180.0 || hello.origin_lon > 180.0 || hello.origin_lat < -90.0 ||
                hello.origin_lat > 90.0)
                throw Failed{"the origin's degrees are none on the earth"};
        }));
}

}  // namespace trochoid::conformance::server
