#include "server/world/wind_sea.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"
#include "server/world/dispersion.hpp"
#include "server/world/integer_math.hpp"

namespace trochoid {

WindSea wind_sea(double speed, int64_t fetch) {
    TROCHOID_ASSERT(speed > 0.0 && fetch > 0, "wind of {} m/s over {} lattice units", speed, fetch);
    constexpr double speed_at_ten_metres = 1.0 / 1.026;
    const double u10 = speed * speed_at_ten_metres;
    const double metres = to_metres(fetch);
    const double developed_height = 0.21 * speed * speed / gravity;
    const double developed_omega = 0.877 * gravity / speed;
    const double young_height = 0.0016 * u10 * std::sqrt(metres / gravity);
    const double young_omega = 22.0 * cube_root(gravity * gravity / (u10 * metres));
    return {std::min(developed_height, young_height), std::max(developed_omega, young_omega)};
}

}  // namespace trochoid
