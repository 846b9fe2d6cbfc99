#include "client/scene/sea_mesh.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>

namespace trochoid {
namespace {

constexpr FrustumPlanes everything{glm::vec4(0, 0, 0, 1), glm::vec4(0, 0, 0, 1), glm::vec4(0, 0, 0, 1),
                                   glm::vec4(0, 0, 0, 1), glm::vec4(0, 0, 0, 1)};

MeshEye eye_at(double x, double z, float altitude) {
    MeshEye eye;
    eye.cell = {static_cast<int32_t>(to_lattice(x)), static_cast<int32_t>(to_lattice(z))};
    eye.altitude = altitude;
    eye.filter = {0.5F, 1.0F / 75};
    return eye;
}

TEST(EdgeLevel, is_the_power_of_two_nearest_to_length_over_spacing) {
    const MeshEye eye = eye_at(3, -2, 20);
    for (int side_log2 = 13; side_log2 <= 22; ++side_log2)
        for (int i = -40; i <= 40; ++i) {
            const int side = 1 << side_log2;
            const glm::ivec2 start(i * 70'001, 1 << 16);
            const int level = edge_level(eye, start, true, side);
            const double wanted =
                side / 1024.0 / static_cast<double>(spacing_at(eye, start + glm::ivec2(side / 2, 0)));
            const double nearest = std::exp2(std::round(std::log2(wanted)));
            EXPECT_TRUE(std::has_single_bit(static_cast<uint32_t>(level)));
            EXPECT_NEAR(level, std::min(std::max(nearest, 2.0), 64.0), 1e-9) << wanted;
        }
}

/// Where a fine patch meets a coarse one, two fine edges have the vertices of the coarse edge.
TEST(EdgeLevel, both_halves_of_a_coarse_edge_take_half_its_segments) {
    const MeshEye eye = eye_at(11, 7, 4);
    for (const glm::uvec2 anchor_low :
         {glm::uvec2(0), glm::uvec2(3U << 20, 5U << 20), glm::uvec2(0xfff00000U, 0x80000000U)})
        for (const bool along_x : {true, false})
            for (int side_log2 = 13; side_log2 <= 23; ++side_log2) {
                const int side = 1 << side_log2;
                const uint32_t low = along_x ? anchor_low.x : anchor_low.y;
                // The first place at or after the anchor that is a multiple of the coarse edge.
                const auto coarse =
                    static_cast<int32_t>((0U - low) & (2U * static_cast<uint32_t>(side) - 1U));
                const glm::ivec2 start =
                    along_x ? glm::ivec2(coarse, 77 << 13) : glm::ivec2(77 << 13, coarse);
                const glm::ivec2 next = start + (along_x ? glm::ivec2(side, 0) : glm::ivec2(0, side));
                const int whole = edge_level(eye, start, along_x, side * 2);
                EXPECT_EQ(halved_edge_level(eye, anchor_low, start, along_x, side) * 2, whole);
                EXPECT_EQ(halved_edge_level(eye, anchor_low, next, along_x, side) * 2, whole);
            }
}

InterestState state_of(std::initializer_list<PatchKey> keys) {
    InterestState state;
    for (const PatchKey key : keys) state.patches[key].key = key;
    return state;
}

TEST(CoarserEdges, are_those_towards_a_patch_one_level_up) {
    // A coarse patch west and one south of a fine one at (2, 1); its east and north neighbours are as fine or missing.
    const PatchKey fine{16, 2, 1};
    const InterestState state = state_of({fine, {17, 0, 0}, {17, 1, 1}, {16, 3, 1}});
    EXPECT_EQ(coarser_edges(state.patches, fine), west_edge | south_edge);
    EXPECT_EQ(coarser_edges(state.patches, {16, 3, 1}), uint32_t{south_edge});
    EXPECT_EQ(coarser_edges(state.patches, {17, 0, 0}), 0U);
    // Left and above of zero.
    const PatchKey negative{16, -1, -2};
    EXPECT_EQ(coarser_edges(state_of({negative, {17, 0, -1}, {17, -1, -2}}).patches, negative),
              east_edge | north_edge);
}

TEST(SeaMesh, covers_every_patch_with_its_quads_and_passes_edges_to_those_at_the_border) {
    const InterestState state = state_of({{16, 2, 1}, {17, 0, 0}});
    Camera camera;
    camera.position = {100, 200};
    const CameraFrame frame = frame_of(camera, DepthRange::classic);
    const SeaMesh mesh =
        build_sea_mesh(state, SeaTable{}, frame, everything, {mesh_eye(frame, {0.5F, 0.01F}), 4'000});
    EXPECT_EQ(mesh.patches_known, 2U);
    EXPECT_EQ(mesh.drawn.size(), 2U);
    int64_t area = 0;
    size_t flagged = 0;
    std::set<std::pair<int32_t, int32_t>> corners;
    for (const SeaQuad& quad : mesh.quads) {
        const int64_t side = int64_t{1} << (quad.shape & 0xffU);
        area += side * side;
        EXPECT_TRUE(corners.insert({quad.x, quad.z}).second);
        const uint32_t edges = (quad.shape >> 8) & 0xffU;
        if (edges == 0) continue;
        ++flagged;
        EXPECT_EQ(edges, uint32_t{west_edge});
        EXPECT_EQ(quad.x, 2 << 16) << "only the western column touches the coarse patch";
    }
    EXPECT_EQ(area, (int64_t{1} << 32) + (int64_t{1} << 34));
    EXPECT_EQ(flagged, size_t{quads_per_side});
}

TEST(SeaMesh, batches_hold_all_quads_in_order_and_keep_to_their_size) {
    InterestState state;
    for (int32_t z = -4; z < 4; ++z)
        for (int32_t x = -4; x < 4; ++x) state.patches[{16, x, z}] = {};
    const CameraFrame frame = frame_of(Camera{}, DepthRange::classic);
    const SeaMeshSettings settings{mesh_eye(frame, {0.5F, 0.01F}), 4'000};
    const SeaMesh mesh = build_sea_mesh(state, SeaTable{}, frame, everything, settings);
    uint32_t next = 0;
    uint32_t triangles = 0;
    for (const SeaBatch& batch : mesh.batches) {
        EXPECT_EQ(batch.first, next);
        next += batch.count;
        triangles += batch.triangles;
        EXPECT_TRUE(batch.count == 1 || batch.triangles <= settings.triangles_per_draw);
    }
    EXPECT_EQ(next, mesh.quads.size());
    EXPECT_EQ(triangles, mesh.triangles);
    EXPECT_GT(mesh.batches.size(), 1U);
}

TEST(SeaMesh, leaves_out_what_lies_behind_and_beyond_reach) {
    InterestState state = state_of({{16, 0, -3}, {16, 0, 3}, {26, 100, 0}});
    Camera camera;  // looks north, -z
    camera.position = {1 << 15, 0};
    const CameraFrame frame = frame_of(camera, DepthRange::classic);
    const SeaMesh mesh = build_sea_mesh(state, SeaTable{}, frame, planes_of(frame, DepthRange::classic),
                                        {mesh_eye(frame, {0.5F, 0.01F}), 4'000});
    ASSERT_EQ(mesh.drawn.size(), 1U);
    EXPECT_EQ(mesh.drawn[0], (PatchKey{16, 0, -3}));
    EXPECT_EQ(mesh.patches_known, 3U);
}

}  // namespace
}  // namespace trochoid
