#include "client/scene/sea_mesh.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

namespace trochoid {

namespace {

struct Candidate {
    PatchKey key;
    float distance = 0;  // metres from the camera to the nearest point of the patch
    int list = 0;
};

bool within_reach(LatticePoint corner, int64_t side, LatticePoint anchor) {
    const auto inside = [](int64_t v) { return v >= -anchor_reach && v <= anchor_reach; };
    return inside(corner.x - anchor.x) && inside(corner.x + side - anchor.x) && inside(corner.z - anchor.z) &&
           inside(corner.z + side - anchor.z);
}

float distance_to(const Bounds& bounds) {
    const glm::vec3 nearest(std::clamp(0.0F, bounds.low.x, bounds.high.x),
                            std::clamp(0.0F, bounds.low.y, bounds.high.y),
                            std::clamp(0.0F, bounds.low.z, bounds.high.z));
    return glm::length(nearest);
}

std::vector<Candidate> visible(const InterestState& state, const SeaTable& table, const CameraFrame& frame,
                               const FrustumPlanes& planes, WaveBounds& greatest) {
    std::vector<Candidate> seen;
    for (const auto& [key, patch] : state.patches) {
        const LatticePoint corner = corner_of(key);
        if (!within_reach(corner, side_of(key), frame.anchor)) continue;
        const int list = table.list_of(key);
        const WaveBounds waves = table.bounds_of_list(list);
        const Bounds bounds = bounds_of_square(frame, corner, side_of(key), waves.height, waves.displacement);
        if (!may_see(planes, bounds)) continue;
        greatest = {std::max(greatest.height, waves.height),
                    std::max(greatest.displacement, waves.displacement)};
        seen.push_back({key, distance_to(bounds), list});
    }
    // Nearest first: what lies behind then fails the depth test before it costs a fragment.
    std::sort(seen.begin(), seen.end(), [](const Candidate& a, const Candidate& b) {
        return a.distance != b.distance ? a.distance < b.distance : a.key < b.key;
    });
    return seen;
}

/// Two triangles for each cell, as the shader divides the quad's inside.
uint32_t triangles_of(const SeaQuad& quad, const MeshEye& eye) {
    const int side = 1 << (quad.shape & 0xffU);
    return static_cast<uint32_t>(2 * edge_level(eye, {quad.x, quad.z + side / 2}, true, side) *
                                 edge_level(eye, {quad.x + side / 2, quad.z}, false, side));
}

/// Which of a patch's coarser edges its quad (column, row) touches.
uint32_t edges_of_quad(uint32_t patch_edges, int column, int row) {
    uint32_t mine = 0;
    if (column == 0) mine |= west_edge;
    if (row == 0) mine |= north_edge;
    if (column == quads_per_side - 1) mine |= east_edge;
    if (row == quads_per_side - 1) mine |= south_edge;
    return patch_edges & mine;
}

void append_quad(SeaMesh& mesh, const SeaQuad& quad, const SeaMeshSettings& settings) {
    const uint32_t triangles = triangles_of(quad, settings.eye);
    if (mesh.batches.empty() || mesh.batches.back().triangles + triangles > settings.triangles_per_draw)
        mesh.batches.push_back({static_cast<uint32_t>(mesh.quads.size()), 0, 0});
    mesh.quads.push_back(quad);
    mesh.batches.back().count += 1;
    mesh.batches.back().triangles += triangles;
    mesh.triangles += triangles;
}

}  // namespace

LatticePoint corner_of(PatchKey key) { return {int64_t{key.x} << key.level, int64_t{key.z} << key.level}; }
int64_t side_of(PatchKey key) { return int64_t{1} << key.level; }

uint32_t coarser_edges(const std::map<PatchKey, PatchDescriptor>& patches, PatchKey key) {
    const auto coarser_at = [&](int32_t x, int32_t z) {
        return patches.contains({static_cast<uint8_t>(key.level + 1), x >> 1, z >> 1});
    };
    uint32_t edges = 0;
    if (coarser_at(key.x - 1, key.z)) edges |= west_edge;
    if (coarser_at(key.x, key.z - 1)) edges |= north_edge;
    if (coarser_at(key.x + 1, key.z)) edges |= east_edge;
    if (coarser_at(key.x, key.z + 1)) edges |= south_edge;
    return edges;
}

SeaMesh build_sea_mesh(const InterestState& state, const SeaTable& table, const CameraFrame& frame,
                       const FrustumPlanes& planes, const SeaMeshSettings& settings) {
    SeaMesh mesh;
    mesh.patches_known = static_cast<uint32_t>(state.patches.size());
    for (const Candidate& patch : visible(state, table, frame, planes, mesh.bounds)) {
        const LatticePoint corner = corner_of(patch.key);
        const int side_log2 = patch.key.level - quads_per_side_log2;
        const uint32_t edges = coarser_edges(state.patches, patch.key);
        for (int row = 0; row < quads_per_side; ++row)
            for (int column = 0; column < quads_per_side; ++column) {
                SeaQuad quad;
                quad.x = static_cast<int32_t>(corner.x - frame.anchor.x) + (column << side_log2);
                quad.z = static_cast<int32_t>(corner.z - frame.anchor.z) + (row << side_log2);
                quad.shape = static_cast<uint32_t>(side_log2) | edges_of_quad(edges, column, row) << 8 |
                             uint32_t{patch.key.level} << 16;
                quad.list = patch.list;
                const WaveBounds waves = table.bounds_of_list(patch.list);
                const Bounds bounds =
                    bounds_of_square(frame, {frame.anchor.x + quad.x, frame.anchor.z + quad.z},
                                     int64_t{1} << side_log2, waves.height, waves.displacement);
                if (may_see(planes, bounds)) append_quad(mesh, quad, settings);
            }
        mesh.drawn.push_back(patch.key);
    }
    return mesh;
}

}  // namespace trochoid
