#pragma once
#include <glm/vec3.hpp>
#include <vector>

namespace trochoid {

/// A corner of a hull's triangles. x from the stern (-1/2) to the bow (1/2) in lengths, y above the waterline in lengths, z from
/// port (-1/2) to starboard (1/2) in beams.
struct HullVertex {
    glm::vec3 place{0};
    glm::vec3 normal{0, 1, 0};  ///< unit, of a hull seven times as long as broad (all axes in lengths)
    glm::vec3 colour{0};        ///< albedo, linear
    float gloss = 0;            ///< share of a mirror that the paint or the glass is
};

/// A slimness that normals are made for: length over beam.
inline constexpr float hull_slimness = 7.0F;

/// Triangles, three vertices each: a freighter with hatches, her house and funnel aft; closed, with a bulwark around the deck.
std::vector<HullVertex> freighter_hull();
/// A launch: high sides, a cabin ahead of the middle.
std::vector<HullVertex> launch_hull();

}  // namespace trochoid
