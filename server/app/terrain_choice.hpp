#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "protocol/model/terrain.hpp"
#include "protocol/model/view.hpp"

namespace trochoid {

/// Which terrain tiles a view calls for: the quadtree is refined where a tile's geometric error would show as more than the
/// accepted error (pixels on the screen), whichever way the camera looks, as it turns faster than tiles travel.
class TerrainChoice {
public:
    /// Null terrain: no tiles. Works out the error of every tile: about 0.1 s for a million samples.
    explicit TerrainChoice(std::shared_ptr<const TerrainGrid> grid);

    /// Coarse before fine, near before far within a level; every tile's parent is in the list.
    std::vector<TerrainTileKey> tiles_for(const ViewState& view) const;
    /// The tile itself; one that `tiles_for` named.
    TerrainTile tile(TerrainTileKey key) const { return make_tile(*grid_, key); }

private:
    double error_metres(TerrainTileKey key) const;
    double distance_metres(TerrainTileKey key, const ViewState& view) const;
    bool touches_grid(TerrainTileKey key) const;

    std::shared_ptr<const TerrainGrid> grid_;
    std::map<std::tuple<uint8_t, int32_t, int32_t>, double> errors_;  // m; levels above 0
};

}  // namespace trochoid
