#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>

#include "protocol/codec/messages.hpp"
#include "protocol/units/sea_time.hpp"
#include "server/world/world.hpp"

namespace trochoid {

/// A bed of 2 km by 2 km, 10 m deep, in a sea of 20 m.
inline std::shared_ptr<const TerrainGrid> shoal() {
    TerrainGrid grid;
    grid.columns = grid.rows = 65;
    grid.origin_x = grid.origin_z = -32 * 32768;
    grid.heights.assign(size_t{65} * 65, -10 * 32);
    grid.open_sea_depth = -20 * 1024;
    return std::make_shared<const TerrainGrid>(grid);
}

/// A wind of four trains towards the south whose box holds the origin; for ever where its life is 0.
inline StartWind breeze(int64_t life_us = 0) {
    StartWind wind;
    wind.speed = 9.0F;
    wind.towards_degrees = 180.0F;
    wind.origin = {0, to_lattice(-1500.0)};
    wind.fetch = to_lattice(3000.0);
    wind.width = to_lattice(3000.0);
    wind.trains = 4;
    wind.seed = 5;
    wind.life_us = life_us;
    return wind;
}

}  // namespace trochoid
