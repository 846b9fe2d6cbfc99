#pragma once
#include <iosfwd>

namespace trochoid {

/// Golden vectors of a second sea, made of what the reference sea has none of: boxes whose ramps meet, boxes limited one way only,
/// wakes from the bow on, records at the ends of their ranges.
void write_edges(std::ostream& out);

}  // namespace trochoid
