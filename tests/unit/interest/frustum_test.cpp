#include "server/interest/frustum.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/interest/sample_world.hpp"

namespace trochoid {
namespace {

/// The obvious twin: the point turned into the camera's frame by quaternion products, then compared with the tangents.
struct InCamera {
    double right = 0.0, up = 0.0, ahead = 0.0;
};

InCamera in_camera(const ViewState& v, Vec3 p) {
    // p' = conj(q) p q, with the vector part of q being (x, y, z).
    const double x = -v.qx, y = -v.qy, z = -v.qz, w = v.qw;
    const double tx = 2.0 * (y * p.z - z * p.y), ty = 2.0 * (z * p.x - x * p.z),
                 tz = 2.0 * (x * p.y - y * p.x);
    return {p.x + w * tx + (y * tz - z * ty), p.y + w * ty + (z * tx - x * tz),
            -(p.z + w * tz + (x * ty - y * tx))};
}

bool sees(const ViewState& v, Vec3 p, double near_distance, double far_distance) {
    const InCamera c = in_camera(v, p);
    return c.ahead >= near_distance && c.ahead <= far_distance &&
           std::abs(c.right) <= static_cast<double>(v.tan_half_width) * c.ahead &&
           std::abs(c.up) <= static_cast<double>(v.tan_half_height) * c.ahead;
}

bool inside(const SixPlanes& planes, Vec3 p) { return !outside(planes, {p, {0.0, 0.0, 0.0}}); }

Vec3 random_point(Dice& dice, double scale) {
    return {dice.between(-scale, scale), dice.between(-scale, scale), dice.between(-scale, scale)};
}

ViewState random_view(Dice& dice) {
    ViewState v = looking({0, 0}, 20.0, dice.between(-3.0, 3.0), dice.between(-1.5, 1.5));
    v.tan_half_width = static_cast<float>(dice.between(0.05, 1.6));
    v.tan_half_height = static_cast<float>(dice.between(0.05, 1.2));
    return v;
}

TEST(Frustum, PlanesFromTheCombinedMatrixAgreeWithTheDirectTest) {
    Dice dice(1);
    int inside_count = 0;
    for (int i = 0; i < 200; ++i) {
        const ViewState view = random_view(dice);
        const SixPlanes planes = planes_of(view, 0.1, 500.0);
        for (int j = 0; j < 500; ++j) {
            const Vec3 p = random_point(dice, 600.0);
            const bool expected = sees(view, p, 0.1, 500.0);
            inside_count += expected ? 1 : 0;
            EXPECT_EQ(inside(planes, p), expected) << p.x << " " << p.y << " " << p.z;
        }
    }
    EXPECT_GT(inside_count, 2000);
}

TEST(Frustum, LooksAlongMinusZOfItsQuaternion) {
    const Vec3 north = forward_of(looking({0, 0}, 0.0, 0.0, 0.0));
    EXPECT_NEAR(north.z, -1.0, 1e-6);
    const Vec3 east_and_down = forward_of(looking({0, 0}, 0.0, 3.14159265358979 / 2, -0.5));
    EXPECT_NEAR(east_and_down.x, std::cos(0.5), 1e-6);
    EXPECT_NEAR(east_and_down.y, -std::sin(0.5), 1e-6);
    EXPECT_NEAR(east_and_down.z, 0.0, 1e-6);
}

TEST(Frustum, PaddingHoldsEveryMovedAndTurnedView) {
    Dice dice(2);
    int seen = 0;
    for (int i = 0; i < 300; ++i) {
        CullKey key = key_around(random_view(dice));
        const SixPlanes padded = padded_planes(key.anchor, to_metres(key.slack), 0.15, 500.0);
        for (int j = 0; j < 300; ++j) {
            const ViewState view = within_slack(key, dice);
            const Vec3 p = random_point(dice, dice.between(5.0, 900.0));
            const Vec3 relative{p.x - to_metres(view.position.x),
                                p.y - to_metres(view.altitude - key.anchor.altitude),
                                p.z - to_metres(view.position.z)};
            if (!sees(view, relative, 0.1, 500.0)) continue;
            ++seen;
            EXPECT_TRUE(inside(padded, p)) << p.x << " " << p.y << " " << p.z;
        }
    }
    EXPECT_GT(seen, 2000);
}

TEST(Frustum, PaddingIsNotMuchWiderThanItMustBe) {
    const ViewState view = looking({0, 0}, 20.0, 0.0, 0.0);
    const SixPlanes padded = padded_planes(view, 8.0, 0.15, 10'000.0);
    // 45 degrees to the right, turned by 8.5: a point at 60 degrees, and one behind, are out.
    EXPECT_TRUE(inside(padded, {1000.0 * 1.3, 0.0, -1000.0}));
    EXPECT_FALSE(inside(padded, {1000.0 * 1.75, 0.0, -1000.0}));
    EXPECT_FALSE(inside(padded, {0.0, 0.0, 9.0}));
}

TEST(Frustum, LensTooWideForPlanesKeepsEverything) {
    ViewState view = looking({0, 0}, 20.0, 0.0, 0.0);
    view.tan_half_width = 20.0F;
    const SixPlanes padded = padded_planes(view, 8.0, 0.15, 10'000.0);
    EXPECT_TRUE(inside(padded, {500.0, 0.0, 20.0}));
}

TEST(Frustum, BoxIsOutsideOnlyBehindOnePlane) {
    const SixPlanes planes = planes_of(looking({0, 0}, 0.0, 0.0, 0.0), 0.1, 1000.0);
    EXPECT_FALSE(outside(planes, {{0.0, 0.0, -100.0}, {1.0, 1.0, 1.0}}));
    EXPECT_TRUE(outside(planes, {{0.0, 0.0, 100.0}, {1.0, 1.0, 1.0}}));
    EXPECT_FALSE(outside(planes, {{0.0, 0.0, 100.0}, {1.0, 1.0, 101.0}}));
    EXPECT_TRUE(outside(planes, {{0.0, 0.0, -1100.0}, {1.0, 1.0, 99.0}}));
    EXPECT_TRUE(outside(planes, {{150.0, 0.0, -100.0}, {20.0, 1.0, 20.0}}));
    EXPECT_FALSE(outside(planes, {{150.0, 0.0, -100.0}, {30.0, 1.0, 30.0}}));
}

}  // namespace
}  // namespace trochoid
