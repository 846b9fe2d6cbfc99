#pragma once
#include <cstdint>

#include "protocol/model/wave_train_box.hpp"
#include "protocol/units/lattice.hpp"
#include "protocol/units/sea_time.hpp"

// The ranges that a wind or a hand-written box is checked against, in scene files and live commands alike.
namespace trochoid {

/// Wind speed at 19.5 m, m/s.
inline constexpr float slowest_wind = 1.0F;
inline constexpr float fastest_wind = 40.0F;
/// Fetch and width of a wind, lattice units: 32 m to 1048 km.
inline constexpr int64_t shortest_wind_side = 32 * lattice_per_metre;
inline constexpr int64_t longest_wind_side = longest_side;
/// Life of a wind: 0 (until stopped), or 1 s to 2^55 us (1100 years).
inline constexpr int64_t shortest_life_us = microseconds_per_second;
inline constexpr int64_t longest_life_us = int64_t{1} << 55;
inline constexpr uint16_t most_trains = 64;
inline constexpr uint32_t most_boxes = 1024;
/// Hand-written trains, metres.
inline constexpr double shortest_wavelength = 0.05;
inline constexpr double longest_wavelength = 4000.0;
/// Growth and decay of a hand-written box, microseconds (6 days).
inline constexpr int64_t longest_ramp_us = int64_t{1} << 39;

}  // namespace trochoid
