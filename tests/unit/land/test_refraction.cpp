#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/land/land_trace.hpp"
#include "tests/unit/land/coasts.hpp"

namespace trochoid {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double wavelength = 100.0;

/// k(D) over the deep one, by libm.
double ratio_at(double depth) {
    const double kd = 2.0 * pi * depth / wavelength;
    double x = kd + 1.0;
    for (int i = 0; i < 100; ++i) x = 0.5 * (x + kd / std::tanh(x));
    return x / kd;
}

/// 4 km of 1 : 40 from 100 m depth to a straight shore at x = 2000, alike for all z.
double beach(double x, double) { return std::clamp((x - 2000.0) / 40.0, -100.0, 20.0); }

LandSettings no_cut() {
    LandSettings s;
    s.breaking_ratio = 0.0;
    return s;
}

/// Direction of the refracted wave vector at a node, degrees from the shore's normal.
double crest_angle(const TracedLand& land, const WaveTrain& t, double x, double z) {
    const LandField& field = *land.fields.at(0);
    const double kx = static_cast<double>(t.kx) * 0x1p-22 +
                      (node_value(field, x + 32, z).shift - node_value(field, x - 32, z).shift) / 64.0;
    const double kz = static_cast<double>(t.kz) * 0x1p-22 +
                      (node_value(field, x, z + 32).shift - node_value(field, x, z - 32).shift) / 64.0;
    return std::atan2(kz, kx) * 180.0 / pi;
}

class Snell : public ::testing::TestWithParam<double> {};

TEST_P(Snell, EikonalBendsCrestsOnAPlaneBeach) {
    const double incidence = GetParam();
    const TerrainGrid terrain = coast(769, 15, 100, beach);
    WaveTrainBox b = open_box(incidence);
    b.trains = {train(incidence, wavelength, 0.1)};
    const TracedLand land = trace_land(b, terrain, {1}, no_cut());
    ASSERT_EQ(land.fields.size(), 1U);
    // Node columns at 32 m; the waves come from the north-west, so the southern half has only seen the beach.
    for (const double x : {0.0, 800.0, 1184.0, 1600.0, 1696.0}) {
        const double depth = (2000.0 - x) / 40.0;
        const double expected = std::asin(std::sin(incidence * pi / 180.0) / ratio_at(depth)) * 180.0 / pi;
        EXPECT_NEAR(crest_angle(land, b.trains[0], x, 3200.0), expected, 0.25) << "depth " << depth;
    }
}
INSTANTIATE_TEST_SUITE_P(Refraction, Snell, ::testing::Values(0.0, 30.0, 60.0));

TEST(Refraction, StraightRaysGiveTheIntegral) {
    const TerrainGrid terrain = coast(257, 15, 100, beach);
    WaveTrainBox b = open_box(0.0);
    b.trains = {train(0.0, wavelength, 0.1)};
    LandSettings settings = no_cut();
    settings.refraction = Refraction::straight;
    const TracedLand land = trace_land(b, terrain, {1}, settings);
    ASSERT_EQ(land.fields.size(), 1U);
    for (const double x : {-512.0, 512.0, 1024.0, 1600.0, 1856.0}) {
        double integral = 0.0;
        for (double u = -2048.0; u < x; u += 0.5)
            integral += (ratio_at(std::min(-beach(u + 0.25, 0.0), 100.0)) - 1.0) * 0.5 / wavelength;
        const double shift = node_value(*land.fields[0], x, 0.0).shift;
        EXPECT_NEAR(shift, integral, 0.002 + 0.002 * integral) << "x " << x;
    }
}

TEST(Refraction, StraightAndEikonalAgreeWhereDepthIsAlikeAcross) {
    const TerrainGrid terrain = coast(257, 15, 100, beach);
    WaveTrainBox b = open_box(0.0);
    b.trains = {train(0.0, wavelength, 0.1)};
    LandSettings settings = no_cut();
    const TracedLand eikonal = trace_land(b, terrain, {1}, settings);
    settings.refraction = Refraction::straight;
    const TracedLand straight = trace_land(b, terrain, {1}, settings);
    for (double x = -2048.0; x <= 1952.0; x += 32.0)
        EXPECT_NEAR(node_value(*eikonal.fields[0], x, 320.0).shift,
                    node_value(*straight.fields[0], x, 320.0).shift, 1e-4)
            << x;
}

TEST(Refraction, PaperShiftFollowsLocalDepthOnly) {
    const TerrainGrid terrain = coast(257, 15, 100, beach);
    WaveTrainBox b = open_box(30.0);
    b.trains = {train(30.0, wavelength, 0.1)};
    LandSettings settings = no_cut();
    settings.refraction = Refraction::phase_shift;
    settings.phase_shift_turns = 2.0;
    const TracedLand land = trace_land(b, terrain, {1}, settings);
    for (const double x : {-512.0, 512.0, 1024.0, 1600.0})
        EXPECT_NEAR(node_value(*land.fields[0], x, 640.0).shift, 2.0 * (ratio_at((2000.0 - x) / 40.0) - 1.0),
                    0.02)
            << "x " << x;
}

TEST(Refraction, NoneLeavesPhasesAlone) {
    const TerrainGrid terrain = coast(129, 15, 100, beach);
    WaveTrainBox b = open_box(30.0);
    b.trains = {train(30.0, wavelength, 1.0)};
    LandSettings settings;
    settings.refraction = Refraction::none;
    const TracedLand land = trace_land(b, terrain, {1}, settings);
    ASSERT_EQ(land.fields.size(), 1U);
    for (const auto& block : land.fields[0]->blocks())
        for (const int32_t shift : block->shift) ASSERT_EQ(shift, 0);
}

TEST(Refraction, WavesTooShortForTheNodesGetGainsButNoShift) {
    const TerrainGrid terrain = coast(129, 15, 100, beach);
    WaveTrainBox b = open_box(0.0);
    b.trains = {train(0.0, 6.0, 0.2)};
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    ASSERT_EQ(land.fields.size(), 1U);
    for (const auto& block : land.fields[0]->blocks())
        for (const int32_t shift : block->shift) ASSERT_EQ(shift, 0);
    EXPECT_EQ(node_value(*land.fields[0], 2048.0, 0.0).gain, 0.0);
}

TEST(Refraction, CrestsLagBehindAShoalAndEvenOutDownstream) {
    const TerrainGrid terrain = coast(513, 15, 100, [](double x, double z) {
        const double r = std::hypot(x + 4000.0, z);
        return r < 1000.0 ? -6.0 - 94.0 * (r / 1000.0) * (r / 1000.0) : -100.0;
    });
    WaveTrainBox b = open_box(0.0);
    b.trains = {train(0.0, wavelength, 0.5)};
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    const LandField& field = *land.fields.at(0);
    const double behind = node_value(field, -2880.0, 0.0).shift;
    EXPECT_GT(behind, 0.8);
    EXPECT_EQ(node_value(field, -2880.0, 6400.0).shift, 0.0);
    double before = behind;
    for (double x = -2560.0; x <= 7680.0; x += 320.0) {
        const double here = node_value(field, x, 0.0).shift;
        EXPECT_LT(here, before);
        before = here;
    }
    // Symmetric shoal, symmetric shift.
    for (const double z : {320.0, 640.0, 960.0})
        EXPECT_NEAR(node_value(field, 0.0, z).shift, node_value(field, 0.0, -z).shift, 0.001);
}

}  // namespace
}  // namespace trochoid
