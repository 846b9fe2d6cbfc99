#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "server/land/land_trace.hpp"
#include "tests/unit/land/coasts.hpp"

// Behind obstacles, against Fresnel diffraction (Penny and Price 1952 for small angles): a semi-infinite breakwater across
// waves of normal incidence.

namespace trochoid {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double wavelength = 100.0;

/// |F(w)|, F(w) = e^(i pi/4) / sqrt 2 times the integral of e^(-i pi t^2 / 2) from minus infinity to w: height over the open
/// sea's at w = v sqrt(2 / (L u)), u behind the breakwater, v from the edge of its shadow towards the lit side.
double fresnel(double w) {
    std::complex<double> integral{0.5, -0.5};
    const int steps = 20000;
    for (int i = 0; i < steps; ++i) {
        const double t = w * (i + 0.5) / steps;
        integral += std::polar(1.0, -pi * t * t / 2.0) * (w / steps);
    }
    return std::abs(integral) / std::sqrt(2.0);
}

TEST(Fresnel, TheTruthIsRight) {
    EXPECT_NEAR(fresnel(0.0), 0.5, 1e-6);
    EXPECT_NEAR(fresnel(-1.0), 0.2027, 1e-3);
    EXPECT_NEAR(fresnel(1.2172), 1.170, 2e-3);
    EXPECT_NEAR(fresnel(40.0), 1.0, 1e-2);
}

/// A mole along x = 0 for all z < 0, waves going east, 60 m deep everywhere else.
TracedLand behind_breakwater(Diffraction diffraction, uint8_t step_log2 = 14) {
    const TerrainGrid terrain =
        coast(513, 14, 60, [](double x, double z) { return std::abs(x) < 10.0 && z < 1.0 ? 4.0 : -60.0; });
    WaveTrainBox b = open_box(0.0);
    b.trains = {train(0.0, wavelength, 0.2)};
    LandSettings settings;
    settings.step_log2 = step_log2;
    settings.diffraction = diffraction;
    settings.recovery = 100000.0;
    settings.breaking_ratio = 0.0;
    return trace_land(b, terrain, {1}, settings);
}

double gain_at(const TracedLand& land, double x, double z) {
    return land.fields.at(0)->sample({to_lattice(x), to_lattice(z)}).gain * 0x1p-24;
}

TEST(Diffraction, ParabolicIsFresnelsIntegralBehindABreakwater) {
    const TracedLand land = behind_breakwater(Diffraction::parabolic);
    double worst_shadow = 0.0;
    double worst_lit = 0.0;
    double worst_edge = 0.0;
    for (const double u : {400.0, 800.0, 1600.0, 2400.0}) {
        const double width = std::sqrt(wavelength * u / 2.0);
        // The mole's last node is at z = 0 and reaches half a node farther.
        const double edge = 8.0;
        // The recovery, e-folding in 50 km, goes on meanwhile.
        const double recovered = u / 50000.0;
        worst_edge = std::max(worst_edge, std::abs(gain_at(land, u, edge) - 0.5));
        for (double w = -3.0; w <= 2.0; w += 0.1) {
            const double error = std::abs(gain_at(land, u, edge + w * width) - fresnel(w));
            double& worst = w < 0.0 ? worst_shadow : worst_lit;
            worst = std::max(worst, std::max(error - recovered, 0.0));
        }
    }
    std::printf("parabolic: edge %.3f, shadow %.3f, lit %.3f off\n", worst_edge, worst_shadow, worst_lit);
    EXPECT_LT(worst_edge, 0.03);
    EXPECT_LT(worst_shadow, 0.04);
    EXPECT_LT(worst_lit, 0.06);
}

TEST(Diffraction, WedgeIsAnotherSeaAndThisFarOff) {
    // Energies of directions within 11 degrees: nearly half the energy at the edge (0.6 to 0.7 of the height, about as Goda 1985 has it
    // for random seas), nothing in the middle of the shadow, and no more than the open sea's height anywhere.
    const TracedLand land = behind_breakwater(Diffraction::wedge);
    for (const double u : {400.0, 1600.0}) {
        EXPECT_NEAR(gain_at(land, u, 8.0), 0.65, 0.06) << u;
        EXPECT_LT(gain_at(land, u, -0.3 * u - 60.0), 0.06) << u;
        EXPECT_NEAR(gain_at(land, u, 0.3 * u + 60.0), 1.0, 0.01) << u;
        double worst = 0.0;
        const double width = std::sqrt(wavelength * u / 2.0);
        for (double w = -3.0; w <= 2.0; w += 0.1)
            worst = std::max(worst, std::abs(gain_at(land, u, 8.0 + w * width) - fresnel(w)));
        std::printf("wedge at %g m: up to %.2f off one long-crested wave's diffraction\n", u, worst);
        EXPECT_LT(worst, 0.5);
    }
}

TEST(Diffraction, NoneKeepsShadowsHard) {
    const TracedLand land = behind_breakwater(Diffraction::none);
    for (const double u : {400.0, 1600.0, 2400.0}) {
        EXPECT_EQ(gain_at(land, u, 40.0), 1.0);
        EXPECT_LT(gain_at(land, u, -24.0), 0.03);
    }
}

class Symmetry : public ::testing::TestWithParam<Diffraction> {};

TEST_P(Symmetry, ARoundIslandHasTheSameSeaOnBothSides) {
    const TerrainGrid terrain = coast(257, 15, 60, [](double x, double z) {
        return std::clamp((600.0 - std::hypot(x, z)) / 12.0, -60.0, 40.0);
    });
    LandSettings settings;
    settings.diffraction = GetParam();
    settings.shallow_orbits = true;
    const auto traced = [&](double heading) {
        WaveTrainBox b = open_box(heading);
        b.trains = {train(heading, 80.0, 0.3)};
        return trace_land(b, terrain, {1}, settings);
    };
    const TracedLand east = traced(0.0);
    const TracedLand south = traced(90.0);
    const TracedLand west = traced(180.0);
    const TracedLand north = traced(270.0);
    const auto node = [](const TracedLand& land, int32_t x, int32_t z) {
        const LandBlock* block = land.fields.at(0)->find({x >> 4, z >> 4});
        const auto n = static_cast<size_t>((z & 15) * block_nodes + (x & 15));
        return block == nullptr ? std::array<int32_t, 3>{0, unit_node_gain, unit_node_orbit}
                                : std::array<int32_t, 3>{block->shift[n], block->gain[n], block->orbit[n]};
    };
    int lee = 0;
    for (int32_t z = -150; z <= 150; ++z)
        for (int32_t x = -150; x <= 150; ++x) {
            const auto here = node(east, x, z);
            ASSERT_EQ(here, node(east, x, -z)) << x << " " << z;
            ASSERT_EQ(here, node(west, -x, z)) << x << " " << z;
            ASSERT_EQ(here, node(south, z, x)) << x << " " << z;
            ASSERT_EQ(here, node(north, z, -x)) << x << " " << z;
            lee += here[1] < unit_node_gain / 2 && x > 20 ? 1 : 0;
        }
    EXPECT_GT(lee, 300);
}
INSTANTIATE_TEST_SUITE_P(Diffraction, Symmetry,
                         ::testing::Values(Diffraction::none, Diffraction::wedge, Diffraction::parabolic));

TEST(Diffraction, OnlyTheAdvertisedSettingsReachBesideTheRay) {
    // With neither lateral filling nor refraction a ray knows nothing of its neighbours: the paper's model.
    const TerrainGrid terrain = coast(257, 15, 60, [](double x, double z) {
        return std::abs(x) < 100.0 && std::abs(z) < 500.0 ? 5.0 : -60.0;
    });
    WaveTrainBox b = open_box(0.0);
    b.trains = {train(0.0, 40.0, 0.3)};
    LandSettings settings;
    settings.diffraction = Diffraction::none;
    settings.refraction = Refraction::none;
    const TracedLand land = trace_land(b, terrain, {1}, settings);
    for (double x = 160.0; x < 2400.0; x += 32.0) {
        EXPECT_EQ(gain_at(land, x, 640.0), 1.0);
        // The belt's recovery: 2000 m from 0 to 1.
        EXPECT_NEAR(gain_at(land, x, 0.0), std::min((x - 96.0) / 2000.0, 1.0), 0.02) << x;
    }
}

}  // namespace
}  // namespace trochoid
