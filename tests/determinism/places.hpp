#pragma once
#include <string>
#include <vector>

#include "protocol/model/sea.hpp"

namespace trochoid {

/// Where something is to be seen: the world's origin, and the middle of the grown part of the first boxes, four at most.
std::vector<LatticePoint> places_to_look_at(const SeaInstant& instant);

/// "tile LEVEL/X,Z point X,Z": the patch of 64 m that the point lies in, and the point, lattice units.
std::string tile_and_point(LatticePoint p);

}  // namespace trochoid
