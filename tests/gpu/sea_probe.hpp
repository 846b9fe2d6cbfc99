#pragma once
#include <cstdint>
#include <vector>

#include "client/gpu/mesher.hpp"
#include "client/scene/scene_input.hpp"

namespace trochoid {

/// What the last shader of a mesher computed at one vertex.
struct ProbedVertex {
    int32_t x = 0;  ///< relative to the anchor, lattice units
    int32_t z = 0;
    float shift[3] = {};            ///< aX, aY, aZ
    float normal[3] = {};           ///< unnormalised
    uint32_t phases = 0;            ///< digest of all phases in the order of the sum
    uint32_t trains_looked_at = 0;  ///< wakes and noise apart
    uint32_t trains_evaluated = 0;  ///< those with a weight
};

struct Probe {
    LatticePoint anchor;
    std::vector<ProbedVertex> vertices;  ///< three a triangle
};

/// Runs a mesher's shipped shaders over a state without drawing and reads their outputs back (transform feedback).
/// Covers everything around the camera, whether in view or not. By default nothing fades (`options.authoritative`).
Probe probe_sea(const InterestState& state, SeaTime now, const Camera& camera, const DrawOptions& options);
/// The same of what a picture would draw: in view, vertices as far apart as `options.error_px` asks.
Probe probe_view(const InterestState& state, SeaTime now, const Camera& camera, const DrawOptions& options);
Probe probe_sea(const InterestState& state, SeaTime now, const Camera& camera,
                Layers layers = displayed_layers);

}  // namespace trochoid
