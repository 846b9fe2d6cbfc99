#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "protocol/model/terrain.hpp"
#include "protocol/model/view.hpp"
#include "protocol/units/lattice.hpp"

namespace trochoid {

/// Which terrain tiles a view calls for: the quadtree is refined where a tile's geometric error would show as more than the
/// accepted error (pixels on the screen), whichever way the camera looks, as it turns faster than tiles travel.
class TerrainChoice {
public:
    /// Null terrain: no tiles. Works out the error of every tile: about 0.1 s for a million samples.
    explicit TerrainChoice(std::shared_ptr<const TerrainGrid> grid);
    /// After a change of the terrain, a grid of the same outline that differs inside `touched` only: works out the errors of the tiles
    /// that it touches.
    TerrainChoice(const TerrainChoice& before, std::shared_ptr<const TerrainGrid> grid,
                  const LatticeRect& touched);

    /// Coarse before fine, near before far within a level; every tile's parent is in the list.
    std::vector<TerrainTileKey> tiles_for(const ViewState& view) const;
    /// The tile itself; one that `tiles_for` named.
    TerrainTile tile(TerrainTileKey key) const { return make_tile(*grid_, key); }
    /// Number of the last change that touched the tile, 0: none. A tile that was sent at another revision is out of date.
    uint32_t revision(TerrainTileKey key) const;

private:
    double error_metres(TerrainTileKey key) const;
    double distance_metres(TerrainTileKey key, const ViewState& view) const;
    bool touches_grid(TerrainTileKey key) const;
    LatticeRect rect_of(TerrainTileKey key) const;

    std::shared_ptr<const TerrainGrid> grid_;
    std::map<std::tuple<uint8_t, int32_t, int32_t>, double> errors_;  // m; levels above 0
    // Of tiles that a change has touched, all levels: as many as there are tiles at most, however often the land changes.
    std::map<std::tuple<uint8_t, int32_t, int32_t>, uint32_t> revisions_;
    uint32_t changes_ = 0;
};

}  // namespace trochoid
