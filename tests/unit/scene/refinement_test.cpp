// The criteria of refinement (row D4): pure, symmetric, and what each leaves out.
#include <gtest/gtest.h>

#include "client/scene/edge_level.hpp"

namespace trochoid {
namespace {

MeshEye eye_by(Refinement refinement, double altitude = 12) {
    Camera camera;
    camera.position = {to_lattice(321.5), to_lattice(-77.25)};
    camera.fraction_x = 0.375;
    camera.altitude_m = altitude;
    camera.yaw = 0.4;
    camera.pitch = -0.1;
    const CameraFrame frame = frame_of(camera, DepthRange::classic);
    return mesh_eye(frame, {0.5F, 0.016F}, refinement, planes_of(frame, DepthRange::classic), 2.0F);
}

/// Places all around, from metres to kilometres.
std::vector<glm::ivec2> places() {
    std::vector<glm::ivec2> all;
    uint32_t dice = 7;
    const auto roll = [&] {
        dice = dice * 1664525U + 1013904223U;
        return static_cast<int32_t>(dice >> 8U) - (1 << 23);
    };
    for (int i = 0; i < 3'000; ++i) {
        const int finer = i % 12;
        const int x = roll() >> finer;
        all.emplace_back(x, roll() >> finer);
    }
    return all;
}

TEST(Refinement, an_edge_is_judged_alike_from_either_end) {
    for (const Refinement refinement : {Refinement::distance, Refinement::screen, Refinement::frustum}) {
        const MeshEye eye = eye_by(refinement);
        const std::vector<glm::ivec2> all = places();
        size_t split = 0;
        for (size_t i = 0; i + 1 < all.size(); ++i) {
            const glm::ivec2 b = all[i] + ((all[i + 1] / 64) << 1);
            EXPECT_EQ(edge_wants_split(eye, all[i], b), edge_wants_split(eye, b, all[i]));
            if (edge_wants_split(eye, all[i], b)) ++split;
        }
        EXPECT_GT(split, 100U);
        EXPECT_LT(split, all.size() - 100);
    }
}

/// Finer than by the distance would show trains that the server has left out.
TEST(Refinement, no_criterion_is_finer_than_the_distance) {
    const MeshEye distance = eye_by(Refinement::distance);
    for (const Refinement refinement : {Refinement::screen, Refinement::frustum}) {
        const MeshEye eye = eye_by(refinement);
        size_t coarser = 0;
        for (const glm::ivec2 place : places()) {
            EXPECT_GE(mesh_spacing_at(eye, place), spacing_at(eye, place));
            for (const int side : {1 << 12, 1 << 15, 1 << 18})
                for (const bool along_x : {false, true}) {
                    const int level = edge_level(eye, place, along_x, side);
                    EXPECT_LE(level, edge_level(distance, place, along_x, side));
                    if (level < edge_level(distance, place, along_x, side)) ++coarser;
                }
        }
        EXPECT_GT(coarser, 500U);
    }
}

TEST(Refinement, the_view_itself_is_refined_by_the_distance) {
    const MeshEye eye = eye_by(Refinement::frustum);
    size_t inside = 0;
    size_t outside = 0;
    for (const glm::ivec2 place : places()) {
        const glm::vec2 d = from_mesh_eye(eye, place);
        float least = 1e9F;
        for (const glm::vec4& side : eye.sides)
            least = std::min(least, side.x * d.x - side.y * eye.altitude + side.z * d.y + side.w);
        if (least >= 0) {
            EXPECT_EQ(mesh_spacing_at(eye, place), spacing_at(eye, place));
            ++inside;
        } else if (-least * spacing_outside_view > 2 * spacing_at(eye, place)) {
            EXPECT_GT(mesh_spacing_at(eye, place), spacing_at(eye, place));
            ++outside;
        }
    }
    EXPECT_GT(inside, 100U);
    EXPECT_GT(outside, 100U);
}

/// From straight above nothing is foreshortened; towards the horizon an edge along the line of sight counts half, one across whole.
TEST(Refinement, the_screen_sees_edges_along_the_line_of_sight_shorter) {
    const MeshEye high = eye_by(Refinement::screen, 3'000);
    EXPECT_NEAR(mesh_length2(high, high.cell, {1024, 0}), 1.0F, 1e-4F);
    const MeshEye low = eye_by(Refinement::screen, 2);
    const glm::ivec2 east = low.cell + glm::ivec2(1'000 * 1024, 0);
    EXPECT_NEAR(mesh_length2(low, east, {1024, 0}), least_foreshortening * least_foreshortening, 1e-4F);
    EXPECT_NEAR(mesh_length2(low, east, {0, 1024}), 1.0F, 1e-4F);
}

}  // namespace
}  // namespace trochoid
