#pragma once
#include <iosfwd>
#include <memory>
#include <vector>

#include "protocol/model/land_field.hpp"

namespace trochoid {

/// Land fields that bend every way: 1 and 2 (which lies over 1, and 3 over 2 elsewhere) with nodes of 4 m, 4 with nodes of 1 km, 5 with
/// nodes of 8 m, which is no base for the others.
std::vector<std::shared_ptr<const LandField>> edge_fields();

/// Golden vectors of what these fields say at points (chapter 2.6).
void write_fields(std::ostream& out);

}  // namespace trochoid
