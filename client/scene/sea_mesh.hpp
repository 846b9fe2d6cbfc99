#pragma once
#include <cstdint>
#include <vector>

#include "client/scene/edge_level.hpp"
#include "client/scene/frustum.hpp"
#include "client/scene/sea_table.hpp"
#include "protocol/model/interest_state.hpp"

namespace trochoid {

/// GL patches along a side of a sea patch.
inline constexpr int quads_per_side_log2 = 2;
inline constexpr int quads_per_side = 1 << quads_per_side_log2;

/// Sides of a square, as bits.
enum EdgeBit : uint32_t { west_edge = 1, north_edge = 2, east_edge = 4, south_edge = 8 };

/// One GL patch as the vertex shader gets it: a square of still water.
struct SeaQuad {
    int32_t x = 0;  ///< north-west corner relative to the anchor, lattice units
    int32_t z = 0;
    uint32_t shape =
        0;  ///< log2 of its side; edges with a coarser neighbour << 8; level of its sea patch << 16
    int32_t list = 0;  ///< header in SeaTable::lists
    bool operator==(const SeaQuad&) const = default;
};

/// One draw: so many quads that it has about `triangles_per_draw` triangles.
struct SeaBatch {
    uint32_t first = 0;
    uint32_t count = 0;
    uint32_t triangles = 0;  ///< estimate
};

struct SeaMeshSettings {
    MeshEye eye;
    /// Mesa's software renderer is quadratic in a draw's triangles; a GPU does not mind the smaller draws.
    uint32_t triangles_per_draw = 4'000;
};

/// The sea patches that the camera may see, nearest first, cut into GL patches.
struct SeaMesh {
    std::vector<SeaQuad> quads;
    std::vector<SeaBatch> batches;
    std::vector<PatchKey> drawn;
    WaveBounds bounds;  ///< greatest over the drawn patches
    uint32_t patches_known = 0;
    uint32_t triangles = 0;  ///< estimate, before the shader's own culling
};
SeaMesh build_sea_mesh(const InterestState& state, const SeaTable& table, const CameraFrame& frame,
                       const FrustumPlanes& planes, const SeaMeshSettings& settings);

/// The edges of a patch whose neighbour is one level coarser, EdgeBits (the server keeps its quadtree balanced 2:1).
uint32_t coarser_edges(const std::map<PatchKey, PatchDescriptor>& patches, PatchKey key);

/// North-west corner and side of a patch, lattice units.
LatticePoint corner_of(PatchKey key);
int64_t side_of(PatchKey key);

}  // namespace trochoid
