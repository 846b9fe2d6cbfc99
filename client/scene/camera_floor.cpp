#include "client/scene/camera_floor.hpp"

#include <algorithm>
#include <cmath>

namespace trochoid {

namespace {

constexpr double above_ground_m = 1.5;
constexpr double above_water_m = 0.6;

bool holds(const TerrainTile& tile, LatticePoint p) {
    const int64_t side = int64_t{terrain_tile_cells} << tile.spacing_log2;
    return p.x >= tile.origin_x && p.z >= tile.origin_z && p.x < tile.origin_x + side &&
           p.z < tile.origin_z + side;
}

/// Highest of the four samples around a place in a tile, metres.
double highest_around(const TerrainTile& tile, LatticePoint p) {
    const auto column = static_cast<size_t>((p.x - tile.origin_x) >> tile.spacing_log2);
    const auto row = static_cast<size_t>((p.z - tile.origin_z) >> tile.spacing_log2);
    const auto at = [&](size_t c, size_t r) { return tile.heights[r * terrain_tile_samples + c]; };
    const int16_t highest =
        std::max({at(column, row), at(column + 1, row), at(column, row + 1), at(column + 1, row + 1)});
    return std::ldexp(static_cast<double>(highest), tile.height_step_log2 - 10);
}

}  // namespace

double CameraFloor::ground_m(const SceneInput& input, LatticePoint p) const {
    const TerrainTile* finest = nullptr;
    for (const auto& tile : input.tiles)
        if (holds(*tile, p) && (finest == nullptr || tile->key.level < finest->key.level))
            finest = tile.get();
    return finest == nullptr ? -1e3 : highest_around(*finest, p);
}

double CameraFloor::water_m(const SceneInput& input, LatticePoint p) {
    if (!input.state) return 0.0;
    if (input.state != state_) {
        state_ = input.state;
        std::vector<std::shared_ptr<const PreparedBox>> boxes;
        for (const auto& [id, record] : state_->boxes) boxes.push_back(prepare(*record, {}));
        sea_ = Sea(std::move(boxes));
    }
    return static_cast<double>(SeaInstant(sea_, input.now).evaluate(p).ay);
}

void CameraFloor::lift(Camera& camera, const SceneInput& input) {
    const double ground = ground_m(input, camera.position) + above_ground_m;
    double lowest = std::max(ground, above_water_m);
    // Far above any crest nobody needs the sea evaluated.
    if (camera.altitude_m < 40.0 && ground < 10.0)
        lowest = std::max(lowest, water_m(input, camera.position) + above_water_m);
    camera.altitude_m = std::max(camera.altitude_m, lowest);
}

}  // namespace trochoid
