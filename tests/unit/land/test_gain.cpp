#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/land/land_trace.hpp"
#include "tests/unit/land/coasts.hpp"

namespace trochoid {
namespace {

constexpr double pi = std::numbers::pi;

double island(double x, double z, double radius) {
    return std::clamp((radius - std::hypot(x, z)) / 8.0, -100.0, 40.0);
}

/// sqrt(cg0 / cg) by libm.
double linear_shoaling(double depth, double wavelength) {
    const double kd = 2.0 * pi * depth / wavelength;
    double x = kd + 1.0;
    for (int i = 0; i < 200; ++i) x = 0.5 * (x + kd / std::tanh(x));
    return std::sqrt((x / kd) / (1.0 + 2.0 * x / std::sinh(2.0 * x)));
}

TEST(Gain, ShoalsAsLinearTheorySays) {
    const double wavelength = 80.0;
    const TerrainGrid terrain =
        coast(257, 15, 80, [](double x, double) { return std::clamp((x - 2000.0) / 40.0, -80.0, 20.0); });
    WaveTrainBox b = open_box(0.0);
    b.trains = {train(0.0, wavelength, 0.01)};
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    for (double x = -1024.0; x < 1950.0; x += 32.0) {
        const double depth = (2000.0 - x) / 40.0;
        const double expected = linear_shoaling(depth, wavelength);
        EXPECT_NEAR(node_value(*land.fields.at(0), x, 0.0).gain, expected, 0.01 * expected)
            << "depth " << depth;
    }
    // Growth ends at depth_min.
    const double largest = linear_shoaling(LandSettings{}.depth_min, wavelength);
    EXPECT_NEAR(land.gain_max / 32768.0, largest, 0.01 * largest);
    EXPECT_GT(largest, 1.3);
}

TEST(Gain, BreakingCapsTheHeightAndReachesZeroAtTheShore) {
    const TerrainGrid terrain =
        coast(257, 15, 80, [](double x, double) { return std::clamp((x - 2000.0) / 40.0, -80.0, 20.0); });
    WaveTrainBox b = open_box(0.0);
    b.trains = {train(0.0, 80.0, 0.6), train(4.0, 30.0, 0.4)};
    const double hs = 4.0 * std::sqrt((0.36 + 0.16) / 2.0);
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    ASSERT_EQ(land.fields.size(), 2U);
    for (const auto& field : land.fields) {
        for (double x = -1024.0; x < 2600.0; x += 32.0) {
            const double depth = (2000.0 - x) / 40.0;
            const double gain = node_value(*field, x, 0.0).gain;
            // Terrain heights are rounded to 1/32 m.
            EXPECT_LE(gain * hs, 0.78 * std::max(depth, 0.0) + 0.014) << "x " << x;
            if (depth <= 0.0) {
                EXPECT_EQ(gain, 0.0) << "x " << x;
            }
        }
        // Two interpolations round off the kink where breaking begins, a node farther out.
        EXPECT_NEAR(node_value(*field, 1920.0, 0.0).gain, 0.78 * 2.0 / hs, 0.04);
    }
}

TEST(Gain, ZeroOnEveryLandNode) {
    const TerrainGrid terrain = coast(257, 15, 60, [](double x, double z) {
        return 12.0 * std::sin(x / 300.0) * std::cos(z / 230.0) - 3.0;
    });
    WaveTrainBox b = open_box(33.0);
    b.trains = {train(33.0, 60.0, 0.5), train(80.0, 15.0, 0.1)};
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    ASSERT_EQ(land.fields.size(), 2U);
    int land_nodes = 0;
    for (const auto& field : land.fields)
        for (double z = -4096.0; z <= 4096.0; z += 32.0)
            for (double x = -4096.0; x <= 4096.0; x += 32.0) {
                if (height_at(terrain, to_lattice(x), to_lattice(z)) < 0) continue;
                ++land_nodes;
                ASSERT_EQ(node_value(*field, x, z).gain, 0.0) << x << " " << z;
            }
    EXPECT_GT(land_nodes, 10000);
}

class Lee : public ::testing::TestWithParam<double> {};

TEST_P(Lee, IsCalmBehindAnIslandAndRecoversSteadily) {
    const double heading = GetParam();
    const TerrainGrid terrain = coast(385, 15, 60, [](double x, double z) { return island(x, z, 600.0); });
    WaveTrainBox b = open_box(heading);
    b.trains = {train(heading, 40.0, 0.3)};
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    const LandField& field = *land.fields.at(0);
    const double ux = std::cos(heading * pi / 180.0);
    const double uz = std::sin(heading * pi / 180.0);
    const auto gain = [&](double u, double v) {
        return field.sample({to_lattice(u * ux - v * uz), to_lattice(u * uz + v * ux)}).gain * 0x1p-24;
    };
    EXPECT_EQ(gain(0.0, 0.0), 0.0);
    EXPECT_LT(gain(700.0, 0.0), 0.15);
    double before = gain(640.0, 0.0);
    for (double u = 680.0; u <= 3200.0; u += 40.0) {
        const double here = gain(u, 0.0);
        EXPECT_GE(here, before - 2e-3) << "u " << u;
        before = here;
    }
    EXPECT_LT(gain(1600.0, 0.0), 0.75);
    EXPECT_EQ(gain(3200.0, 0.0), 1.0);
    // Clear of the wedge in which sheltered directions reach.
    EXPECT_EQ(gain(1000.0, 1600.0), 1.0);
    EXPECT_EQ(gain(-2000.0, 0.0), 1.0);
}
INSTANTIATE_TEST_SUITE_P(Gain, Lee, ::testing::Values(0.0, 45.0, 68.0, 200.0));

TEST(Gain, ShadowEdgesAreSoftAtNodeScale) {
    const TerrainGrid terrain = coast(385, 15, 60, [](double x, double z) { return island(x, z, 600.0); });
    WaveTrainBox b = open_box(0.0);
    b.trains = {train(0.0, 40.0, 0.3)};
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    for (const double x : {960.0, 1280.0, 1920.0})
        for (double z = -1600.0; z < 1600.0; z += 32.0) {
            const double step =
                node_value(*land.fields.at(0), x, z + 32.0).gain - node_value(*land.fields.at(0), x, z).gain;
            EXPECT_LT(std::abs(step), 0.3) << x << " " << z;
        }
}

TEST(Gain, WavesThatBrokeOverABarAreLowBehindIt) {
    // A bar 1 m deep at x = 0, 60 m on both sides of it.
    const TerrainGrid terrain =
        coast(257, 15, 60, [](double x, double) { return -1.0 - std::min(59.0, std::abs(x) / 10.0); });
    WaveTrainBox b = open_box(0.0);
    b.trains = {train(0.0, 50.0, 0.8)};
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    const LandField& field = *land.fields.at(0);
    EXPECT_LT(node_value(field, 0.0, 0.0).gain, 0.36);
    EXPECT_LT(node_value(field, 640.0, 0.0).gain, 0.8);
    EXPECT_GT(node_value(field, -640.0, 0.0).gain, 0.95);
    EXPECT_EQ(node_value(field, 2560.0, 0.0).gain, 1.0);
}

TEST(Gain, ABreakwaterOneNodeWideLeavesNoHoles) {
    const TerrainGrid terrain = coast(257, 15, 60, [](double x, double z) {
        return std::abs(x - z) < 20.0 || std::abs(x - z - 32.0) < 4.0 ? 3.0 : -40.0;
    });
    for (const double heading : {-45.0, -20.0, -70.0}) {
        WaveTrainBox b = open_box(heading);
        b.trains = {train(heading, 20.0, 0.2)};
        const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
        for (double along = -1024.0; along < 1024.0; along += 32.0)
            EXPECT_LT(node_value(*land.fields.at(0), along + 128.0, along - 128.0).gain, 0.35)
                << heading << " " << along;
    }
}

TEST(Gain, SteepnessStaysWithinWhatItSays) {
    // A swell over rocks: kinks in its phase must not turn into cliffs.
    const TerrainGrid terrain = coast(257, 15, 60, [](double x, double z) {
        return -20.0 + 24.0 * std::sin(x / 170.0) * std::sin(z / 130.0);
    });
    WaveTrainBox b = open_box(10.0);
    b.trains = {train(10.0, 90.0, 2.0)};
    b.trains[0].choppiness = 1.0F;
    LandSettings settings;
    settings.breaking_ratio = 0.0;
    LandTraceStats stats;
    const TracedLand land = trace_land(b, terrain, {1}, settings, &stats);
    const double open = 2.0 * pi / 90.0 * 2.0;
    EXPECT_LE(land.steepness_growth * open, 0.45 * 1.001);
    EXPECT_GT(stats.limited_cells, 0U);
    const LandField& field = *land.fields.at(0);
    const TrainConstants c = derive_constants(b.trains[0]);
    double worst = 0.0;
    for (int64_t z = -4000; z < 4000; z += 13)
        for (int64_t x = -4000; x < 4000; x += 13) {
            const LandSample s = field.sample({x * 1024, z * 1024});
            worst = std::max(worst, double(std::hypot(c.kx + s.dshift_dx, c.kz + s.dshift_dz)) / double(c.k) *
                                        (s.gain * 0x1p-24));
        }
    EXPECT_LE(worst, double(land.steepness_growth));
    EXPECT_GT(worst, 1.5);
}

}  // namespace
}  // namespace trochoid
