#include "client/scene/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "client/scene/fly_camera.hpp"
#include "client/scene/frustum.hpp"

namespace trochoid {
namespace {

constexpr double degree = 0.017453292519943295;

Camera looking(double yaw, double pitch) {
    Camera camera;
    camera.yaw = yaw * degree;
    camera.pitch = pitch * degree;
    return camera;
}

TEST(Camera, looks_north_east_south_and_up) {
    EXPECT_NEAR(glm::length(forward_of(looking(0, 0)) - glm::dvec3(0, 0, -1)), 0, 1e-12);
    EXPECT_NEAR(glm::length(forward_of(looking(90, 0)) - glm::dvec3(1, 0, 0)), 0, 1e-12);
    EXPECT_NEAR(glm::length(forward_of(looking(180, 0)) - glm::dvec3(0, 0, 1)), 0, 1e-12);
    EXPECT_NEAR(forward_of(looking(30, 60)).y, std::sin(60 * degree), 1e-12);
}

/// The server sees through the quaternion what we see through the matrix.
TEST(Camera, quaternion_of_the_view_turns_minus_z_into_the_line_of_sight) {
    for (const auto& [yaw, pitch] : {std::pair{0.0, 0.0}, {37.0, -12.0}, {181.0, 45.0}, {-77.0, 80.0}}) {
        const Camera camera = looking(yaw, pitch);
        const ViewState view = view_of(camera, glm::dvec3(0));
        const glm::dquat q(view.qw, view.qx, view.qy, view.qz);
        EXPECT_NEAR(glm::length(q * glm::dvec3(0, 0, -1) - forward_of(camera)), 0, 1e-6);
        EXPECT_NEAR((q * glm::dvec3(1, 0, 0)).y, 0, 1e-6) << "the horizon is level";
    }
}

TEST(Camera, matrix_puts_the_line_of_sight_in_the_middle_and_the_edges_at_the_tangents) {
    const Camera camera = looking(123, -20);
    for (const DepthRange range : {DepthRange::reversed_zero_to_one, DepthRange::classic}) {
        const CameraFrame frame = frame_of(camera, range);
        const glm::vec4 middle =
            frame.clip_from_camera * glm::vec4(glm::vec3(forward_of(camera)) * 50.0F, 1.0F);
        EXPECT_NEAR(middle.x / middle.w, 0, 1e-5);
        EXPECT_NEAR(middle.y / middle.w, 0, 1e-5);
        const ViewState view = view_of(camera, glm::dvec3(0));
        const glm::dvec3 right(std::cos(camera.yaw), 0, std::sin(camera.yaw));
        const glm::vec3 edge(forward_of(camera) + right * static_cast<double>(view.tan_half_width));
        const glm::vec4 at_edge = frame.clip_from_camera * glm::vec4(edge * 50.0F, 1.0F);
        EXPECT_NEAR(at_edge.x / at_edge.w, 1, 1e-5);
    }
}

TEST(Camera, strip_of_a_window_tells_a_view_that_servers_take) {
    Camera camera;
    for (const auto& [width, height] : {std::pair{1280U, 1U}, std::pair{1U, 1280U}, std::pair{8192U, 16U}}) {
        camera.width = width;
        camera.height = height;
        const ViewState view = view_of(camera, glm::dvec3(0));
        for (const float tangent : {view.tan_half_width, view.tan_half_height}) {
            EXPECT_GE(tangent, 0.01F) << width << " x " << height;
            EXPECT_LE(tangent, 20.0F) << width << " x " << height;
        }
    }
}

TEST(Camera, reversed_depth_falls_from_one_to_zero) {
    const Camera camera = looking(0, 0);
    const CameraFrame frame = frame_of(camera, DepthRange::reversed_zero_to_one);
    const auto depth = [&](float metres) {
        const glm::vec4 p = frame.clip_from_camera * glm::vec4(0, 0, -metres, 1);
        return p.z / p.w;
    };
    EXPECT_NEAR(depth(0.3F), 1, 1e-5);
    EXPECT_GT(depth(10'000), depth(10'001));
    EXPECT_GT(depth(1e6F), 0);
}

TEST(Camera, small_steps_add_up_anywhere_in_the_world) {
    Camera camera;
    camera.position = {world_bound - to_lattice(5'000), to_lattice(-12'345'678.9)};
    const Camera start = camera;
    for (int i = 0; i < 100'000; ++i) move(camera, 0.0001, 0, -0.0003);
    const double east =
        to_metres(camera.position.x - start.position.x) + (camera.fraction_x - start.fraction_x) / 1024;
    const double south =
        to_metres(camera.position.z - start.position.z) + (camera.fraction_z - start.fraction_z) / 1024;
    EXPECT_NEAR(east, 10.0, 1e-6);
    EXPECT_NEAR(south, -30.0, 1e-6);
    EXPECT_GE(camera.fraction_x, 0.0);
    EXPECT_LT(camera.fraction_x, 1.0);
}

TEST(Camera, stays_inside_the_world) {
    Camera camera;
    camera.position = {world_bound - 10, 0};
    move(camera, 1e6, 1e9, 0);
    EXPECT_EQ(camera.position.x, world_bound);
    EXPECT_LE(camera.altitude_m, 3'000.0);
}

TEST(Camera, anchor_is_aligned_and_near_on_both_sides_of_zero) {
    for (const int64_t x :
         {int64_t{0}, int64_t{1}, int64_t{-1}, int64_t{987'654'321}, -world_bound, world_bound}) {
        Camera camera;
        camera.position = {x, -x};
        const CameraFrame frame = frame_of(camera, DepthRange::classic);
        EXPECT_EQ(frame.anchor.x % (int64_t{1} << anchor_log2), 0);
        EXPECT_EQ(frame.anchor.x + frame.cell.x, x);
        EXPECT_EQ(frame.anchor.z + frame.cell.y, -x);
        EXPECT_GE(frame.cell.x, 0);
        EXPECT_LT(frame.cell.x, 1 << anchor_log2);
    }
}

TEST(FlyCamera, flies_along_its_line_of_sight_at_its_speed) {
    FlyCamera fly(looking(90, 0));
    FlyInput input;
    input.ahead = 1;
    fly.fly(input, 2.0);
    EXPECT_NEAR(to_metres(fly.camera().position.x) + fly.camera().fraction_x / 1024, 2 * fly.speed(), 1e-9);
    EXPECT_NEAR(fly.velocity().x, fly.speed(), 1e-9);
    input.fast = true;
    fly.fly(input, 0.0);
    EXPECT_NEAR(fly.velocity().x, 5 * fly.speed(), 1e-9);
}

TEST(FlyCamera, mouse_turns_and_never_over_the_top) {
    FlyCamera fly(looking(0, 0));
    FlyInput input;
    input.turn_x = 100;
    input.turn_y = -1e6;
    fly.fly(input, 0.1);
    EXPECT_GT(fly.camera().yaw, 0.0);
    EXPECT_LT(fly.camera().pitch, 1.5707963);
    EXPECT_GT(fly.camera().pitch, 1.5);
}

/// A box is kept whenever one of its points is inside the picture.
TEST(Frustum, keeps_every_box_with_a_point_in_view) {
    const Camera camera = looking(40, -15);
    const CameraFrame frame = frame_of(camera, DepthRange::reversed_zero_to_one);
    const FrustumPlanes planes = planes_of(frame, DepthRange::reversed_zero_to_one);
    size_t seen = 0;
    size_t dropped = 0;
    for (int i = -30; i <= 30; ++i)
        for (int j = -30; j <= 30; ++j) {
            const glm::vec3 middle(static_cast<float>(i) * 11.0F, -20.0F, static_cast<float>(j) * 13.0F);
            const Bounds bounds{middle - 6.0F, middle + 6.0F};
            bool inside = false;
            for (const glm::vec3& corner : {middle, bounds.low, bounds.high}) {
                const glm::vec4 clip = frame.clip_from_camera * glm::vec4(corner, 1);
                inside = inside || (clip.w > 0.4F && std::abs(clip.x) < clip.w && std::abs(clip.y) < clip.w);
            }
            if (inside) {
                ++seen;
                EXPECT_TRUE(may_see(planes, bounds)) << i << ' ' << j;
            }
            if (!may_see(planes, bounds)) ++dropped;
        }
    EXPECT_GT(seen, 100U);
    EXPECT_GT(dropped, 1'000U);
}

}  // namespace
}  // namespace trochoid
