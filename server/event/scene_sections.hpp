#pragma once
#include <cstddef>
#include <string>

#include "server/event/scene.hpp"
#include "server/event/scene_reader.hpp"

// The sections of a scene file that put something into the sea, each read from one table. All throw OperatorError.
namespace trochoid {

inline constexpr size_t longest_name = 64;
inline constexpr NumberRange heading_range{0.0, 359.999999};
/// Sea times in a scene, seconds: 1000 years either way.
inline constexpr NumberRange scene_time{-3.2e10, 3.2e10};
/// Name of the box that [ripples] makes; nothing else may take it.
inline constexpr const char* ripples_name = "ripples";

SceneWind read_wind(SceneReader in, std::string name);
SceneBox read_box(SceneReader in, std::string name);
/// An unlimited box without trains that has been there for ever.
SceneBox read_ripples(SceneReader in);
SceneShip read_ship(SceneReader in, std::string name);
ChangeLand read_breakwater(SceneReader in);

}  // namespace trochoid
