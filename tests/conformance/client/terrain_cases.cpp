#include <fmt/format.h>

#include <algorithm>

#include "tests/conformance/client/refusals.hpp"

// terrain tiles.
namespace trochoid::conformance::client {

namespace {

constexpr uint32_t side = 257;  // four tiles of 64 cells
constexpr int64_t west = -131072 * 32;
constexpr uint32_t spacing_log2 = 15;

void with_grid(ServerHello& hello) {
    hello.terrain.origin_x = west;
    hello.terrain.origin_z = west;
    hello.terrain.spacing_log2 = spacing_log2;
    hello.terrain.columns = side;
    hello.terrain.rows = side;
    hello.terrain.height_step_log2 = 5;
    hello.terrain.open_sea_depth = -102400;
}

TerrainTile tile_of(uint8_t level, int32_t x, int32_t z) {
    constexpr size_t samples = 65 * 65;
    TerrainTile tile;
    tile.key = {level, x, z};
    tile.spacing_log2 = spacing_log2 + level;
    tile.origin_x = west + (int64_t{x} * 64 << tile.spacing_log2);
    tile.origin_z = west + (int64_t{z} * 64 << tile.spacing_log2);
    tile.height_step_log2 = 5;
    for (size_t i = 0; i < samples; ++i)
        tile.heights.push_back(static_cast<int16_t>(static_cast<int>(i % 65) - 40));
    return tile;
}

void add_wrong(Catalogue& all, const char* id, const char* title, void (*spoil)(TerrainTile&), Due due) {
    all.push_back(client_case(id, title, [spoil, due](ClientTrial& trial) {
        ClientPeer& peer = trial.welcome(with_grid);
        TerrainTile tile = tile_of(0, 1, 1);
        spoil(tile);
        peer.send(TerrainTiles{{tile}});
        peer.expect_goodbye(due);
    }));
}

void add_off_grid(Catalogue& all, const char* id, const char* title, void (*spoil)(TerrainTile&)) {
    add_wrong(all, id, title, spoil, {ErrorCode::value_out_of_range, requirement::tiles_of_grid});
}

}  // namespace

void add_terrain_cases(Catalogue& all) {
    all.push_back(client_case("R-136/tiles", "Tiles of all levels, the whole grid", [](ClientTrial& trial) {
        ClientPeer& peer = trial.welcome(with_grid);
        for (uint8_t level = 0; level <= 2; ++level)
            for (int32_t x = 0; x < 4 >> level; ++x)
                for (int32_t z = 0; z < 4 >> level; ++z) peer.send(TerrainTiles{{tile_of(level, x, z)}});
        peer.expect_service();
    }));
    all.push_back(client_case("R-136/tile-again", "A tile that comes again replaces the one held",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = trial.welcome(with_grid);
                                  TerrainTile tile = tile_of(0, 2, 2);
                                  peer.send(TerrainTiles{{tile}});
                                  tile.heights[100] = 77;
                                  peer.send(TerrainTiles{{tile}});
                                  peer.expect_service();
                              }));
    add_off_grid(all, "R-136/origin-x", "A tile's origin is one spacing off",
                 [](TerrainTile& t) { t.origin_x += 1 << spacing_log2; });
    add_off_grid(all, "R-136/origin-z", "A tile's origin is one tile off",
                 [](TerrainTile& t) { t.origin_z -= 64 << spacing_log2; });
    add_off_grid(all, "R-136/spacing", "A tile of another spacing than the grid's", [](TerrainTile& t) {
        t.spacing_log2 = spacing_log2 - 1;
        t.origin_x = west;
        t.origin_z = west;
        t.key = {0, 0, 0};
    });
    // A decoder that knows no grid refuses it for its range, one that has the grid at hand for that.
    add_wrong(all, "R-117/TerrainTiles-origin-odd", "A tile's origin between the grid's samples",
              [](TerrainTile& t) { t.origin_x += 1; }, {ErrorCode::value_out_of_range, any_due_requirement});
    add_wrong(
        all, "R-117/TerrainTiles-level-9", "A tile of level 9", [](TerrainTile& t) { t.key.level = 9; },
        out_of_range);
    add_wrong(
        all, "R-117/TerrainTiles-x-negative", "A tile west of the grid's first",
        [](TerrainTile& t) { t.key.x = -1; }, out_of_range);
    add_wrong(
        all, "R-117/TerrainTiles-height-step", "A tile whose height step no grid may have",
        [](TerrainTile& t) { t.height_step_log2 = 11; }, out_of_range);
    const auto unclear = [&](const char* id, const char* title, void (*spoil)(TerrainTile&)) {
        all.push_back(client_case(std::string("R-136/") + id, title, [spoil](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome(with_grid);
            TerrainTile tile = tile_of(0, 1, 1);
            spoil(tile);
            peer.send(TerrainTiles{{tile}});
            peer.expect_goodbye_or_service({{ErrorCode::value_out_of_range, any_due_requirement}});
        }));
    };
    unclear("beyond-the-grid", "A tile that would lie beyond the grid's last sample: it may be refused",
            [](TerrainTile& t) { t = tile_of(0, 4, 0); });
    unclear("other-height-step", "A tile with another height step than the grid's: it may be refused",
            [](TerrainTile& t) { t.height_step_log2 = 6; });
    all.push_back(client_case("R-136/no-terrain",
                              "A tile, though our hello names no terrain: it may be refused",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = trial.welcome();
                                  peer.send(TerrainTiles{{tile_of(0, 0, 0)}});
                                  peer.expect_goodbye_or_service(
                                      {{ErrorCode::value_out_of_range, any_due_requirement}, unexpected});
                              }));
    const auto spoilt = [](void (*spoil)(wire_fb::TerrainTile&)) {
        return bent<wire_fb::TerrainTiles>(
            ServerMessage{TerrainTiles{{tile_of(0, 0, 0)}}},
            [&](wire_fb::TerrainTiles& body) { spoil(*body.mutable_tiles()->GetMutableObject(0)); });
    };
    const auto refused_on_grid = [&](const char* id, const char* title, const Bytes& payload) {
        all.push_back(client_case(id, title, [payload](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome(with_grid);
            peer.send_payload(payload);
            peer.expect_goodbye(out_of_range);
        }));
    };
    refused_on_grid("R-117/TerrainTiles-heights", "A tile's heights in no plane coding",
                    spoilt([](wire_fb::TerrainTile& t) {
                        std::fill_n(const_cast<uint8_t*>(t.heights()->Data()), 12, uint8_t{0xff});
                    }));
    refused_on_grid("R-117/TerrainTiles-heights-short", "A tile's heights end too early",
                    spoilt([](wire_fb::TerrainTile& t) {
                        auto* length = const_cast<uint8_t*>(t.heights()->Data()) - sizeof(uint32_t);
                        flatbuffers::WriteScalar<uint32_t>(length, t.heights()->size() / 2);
                    }));
}

}  // namespace trochoid::conformance::client
