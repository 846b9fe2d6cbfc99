#pragma once
#include <cstddef>
#include <cstdint>

#include "protocol/codec/messages.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "protocol/units/lattice.hpp"
#include "protocol/units/sea_time.hpp"

// The ranges that winds, hand-written boxes, ships and changes of the land are checked against, in scene files and live
// commands alike; those that the wire checks too stand in protocol/codec/messages.hpp.
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
inline constexpr uint16_t most_trains = 256;
inline constexpr uint32_t most_boxes = 1024;
/// Capillary noise that a wind adds to its water, metres, where it adds any.
inline constexpr float least_noise = 0x1p-20F;
inline constexpr float most_noise = 1.0F;
/// How fast a wind's box may move (row A12), m/s.
inline constexpr float fastest_storm = fastest_wind_box;
/// Hand-written trains, metres.
inline constexpr double shortest_wavelength = 0.05;
inline constexpr double longest_wavelength = 4000.0;
/// Growth and decay of a hand-written box, microseconds (6 days).
inline constexpr int64_t longest_ramp_us = int64_t{1} << 39;
/// Lengths of groups of higher waves (irregular heights), metres.
inline constexpr double shortest_group = 1.0;
inline constexpr double longest_group = 100000.0;
/// Hull of a ship at the water line, metres.
inline constexpr float shortest_ship = shortest_hull;
/// Changes of the land: points of the line, metres of the crest's width and of its height above still water.
inline constexpr size_t fewest_line_points = 2;
inline constexpr float narrowest_crest = 1.0F;
inline constexpr float widest_crest = 2000.0F;
inline constexpr float highest_crest = 200.0F;

}  // namespace trochoid
