#include "server/app/terrain_choice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "protocol/units/lattice.hpp"

namespace trochoid {

TerrainChoice::TerrainChoice(std::shared_ptr<const TerrainGrid> grid) : grid_(std::move(grid)) {
    if (!grid_) return;
    for (uint32_t level = 1; level < tile_levels(*grid_); ++level)
        for (const TerrainTileKey& key : tiles_at_level(*grid_, level))
            errors_[{key.level, key.x, key.z}] = to_metres(tile_geometric_error(*grid_, key));
}

TerrainChoice::TerrainChoice(const TerrainChoice& before, std::shared_ptr<const TerrainGrid> grid,
                             const LatticeRect& touched)
    : grid_(std::move(grid)),
      errors_(before.errors_),
      revisions_(before.revisions_),
      changes_(before.changes_ + 1) {
    for (uint32_t level = 0; level < tile_levels(*grid_); ++level)
        for (const TerrainTileKey& key : tiles_at_level(*grid_, level)) {
            if (!overlap(rect_of(key), touched)) continue;
            revisions_[{key.level, key.x, key.z}] = changes_;
            if (level > 0) errors_[{key.level, key.x, key.z}] = to_metres(tile_geometric_error(*grid_, key));
        }
}

LatticeRect TerrainChoice::rect_of(TerrainTileKey key) const {
    const int64_t side = int64_t{terrain_tile_cells} << (key.level + grid_->spacing_log2);
    const LatticePoint corner{grid_->origin_x + key.x * side, grid_->origin_z + key.z * side};
    return {corner, {corner.x + side, corner.z + side}};
}

uint32_t TerrainChoice::revision(TerrainTileKey key) const {
    const auto place = revisions_.find({key.level, key.x, key.z});
    return place == revisions_.end() ? 0 : place->second;
}

double TerrainChoice::error_metres(TerrainTileKey key) const {
    const auto place = errors_.find({key.level, key.x, key.z});
    return place == errors_.end() ? 0.0 : place->second;  // level 0 is the grid itself
}

bool TerrainChoice::touches_grid(TerrainTileKey key) const {
    const int64_t cells = int64_t{terrain_tile_cells} << key.level;
    return key.x * cells < int64_t{grid_->columns} - 1 && key.z * cells < int64_t{grid_->rows} - 1;
}

// From the camera to the nearest point of the tile at sea level.
double TerrainChoice::distance_metres(TerrainTileKey key, const ViewState& view) const {
    const int64_t side = int64_t{terrain_tile_cells} << (key.level + grid_->spacing_log2);
    const int64_t x = grid_->origin_x + key.x * side;
    const int64_t z = grid_->origin_z + key.z * side;
    const double dx = to_metres(view.position.x - std::clamp(view.position.x, x, x + side));
    const double dz = to_metres(view.position.z - std::clamp(view.position.z, z, z + side));
    const double dy = to_metres(view.altitude);
    return std::sqrt(dx * dx + dy * dy + dz * dz);
}

std::vector<TerrainTileKey> TerrainChoice::tiles_for(const ViewState& view) const {
    if (!grid_) return {};
    const double pixels_per_tangent =
        view.viewport_height / (2.0 * static_cast<double>(view.tan_half_height));
    const double accepted = std::max(static_cast<double>(view.accepted_error_px), 1.0);
    std::vector<TerrainTileKey> chosen;
    std::vector<TerrainTileKey> level{{static_cast<uint8_t>(tile_levels(*grid_) - 1), 0, 0}};
    while (!level.empty()) {
        std::stable_sort(level.begin(), level.end(), [&](const TerrainTileKey& a, const TerrainTileKey& b) {
            return distance_metres(a, view) < distance_metres(b, view);
        });
        chosen.insert(chosen.end(), level.begin(), level.end());
        std::vector<TerrainTileKey> finer;
        for (const TerrainTileKey& key : level) {
            const double distance = std::max(distance_metres(key, view), 1.0);
            if (error_metres(key) * pixels_per_tangent <= accepted * distance) continue;
            for (const auto& [dx, dz] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
                const TerrainTileKey child{static_cast<uint8_t>(key.level - 1), 2 * key.x + dx,
                                           2 * key.z + dz};
                if (touches_grid(child)) finer.push_back(child);
            }
        }
        level = std::move(finer);
    }
    return chosen;
}

}  // namespace trochoid
