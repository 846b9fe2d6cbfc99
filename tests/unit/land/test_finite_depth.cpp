#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "server/land/depth_response.hpp"
#include "server/land/depth_table.hpp"
#include "server/land/finite_depth.hpp"

namespace trochoid {
namespace {

/// k D at k0 D = kd by bisection with libm's tanh.
double solved(double kd) {
    double low = 0.0;
    double high = kd + 2.0;
    for (int i = 0; i < 200; ++i) {
        const double mid = 0.5 * (low + high);
        (mid * std::tanh(mid) < kd ? low : high) = mid;
    }
    return low;
}

double linear_shoaling(double kd) {
    const double x = solved(kd);
    const double twice_n = 1.0 + 2.0 * x / std::sinh(2.0 * x);
    return std::sqrt((x / kd) / twice_n);
}

TEST(FiniteDepth, TableAgreesWithDispersionBySearch) {
    double worst_k = 0.0;
    double worst_shoaling = 0.0;
    for (int i = 1; i <= 4000; ++i) {
        const double kd = 0.001 + two_pi_f64 * i / 4001.0;
        if (kd > two_pi_f64) break;
        worst_k = std::max(worst_k, std::abs(wave_number_ratio(kd) / (solved(kd) / kd) - 1.0));
        worst_shoaling = std::max(worst_shoaling, std::abs(shoaling_ratio(kd) / linear_shoaling(kd) - 1.0));
    }
    EXPECT_LT(worst_k, 2e-6);
    EXPECT_LT(worst_shoaling, 5e-6);
}

TEST(FiniteDepth, DeepWaterStaysDeep) {
    EXPECT_EQ(wave_number_ratio(two_pi_f64), wave_number_ratio(1000.0));
    EXPECT_NEAR(wave_number_ratio(1000.0), 1.0, 1e-5);
    EXPECT_NEAR(shoaling_ratio(1000.0), 1.0, 1e-4);
}

TEST(DepthResponse, ExactlyNothingFromOneWaveLengthOfDepth) {
    const DepthResponse response(1.0 / 80.0, 500.0, 2.0, LandSettings{});
    EXPECT_DOUBLE_EQ(response.deep(), 80.0);
    for (const double depth : {80.0, 81.0, 500.0, 32768.0}) {
        EXPECT_EQ(response.wave_number(depth), 1.0);
        EXPECT_EQ(response.growth(depth), 1.0);
        EXPECT_GE(response.breaking_gain(depth), 2.0);
    }
    EXPECT_NEAR(response.wave_number(79.9), 1.0, 1e-5);
    EXPECT_NEAR(response.growth(79.9), 1.0, 1e-4);
}

TEST(DepthResponse, ShallowOpenSeaIsTheReference) {
    // 200 m waves over 40 m: the open sea itself is shallow for them, and changes nothing all the same.
    const DepthResponse response(1.0 / 200.0, 40.0, 1.0, LandSettings{});
    EXPECT_EQ(response.wave_number(40.0), 1.0);
    EXPECT_EQ(response.growth(40.0), 1.0);
    // 200 m is their length there, so omega^2 / g = k tanh(k 40 m).
    const double k = two_pi_f64 / 200.0;
    const double deep_k = k * std::tanh(k * 40.0);
    EXPECT_NEAR(response.wave_number(10.0), solved(deep_k * 10.0) / 10.0 / k, 1e-5);
    EXPECT_NEAR(response.growth(10.0), linear_shoaling(deep_k * 10.0) / linear_shoaling(deep_k * 40.0), 1e-5);
}

TEST(DepthResponse, BreakingLimitsTheHeightOfTheWholeBox) {
    const DepthResponse response(1.0 / 100.0, 200.0, 3.0, LandSettings{});
    EXPECT_NEAR(response.breaking_gain(2.0), 0.78 * 2.0 / 3.0, 1e-12);
    EXPECT_EQ(response.breaking_gain(0.0), 0.0);
    EXPECT_EQ(response.breaking_gain(-5.0), 0.0);
    // 20 m short waves under a 40 m sea break with it, although they are deep themselves.
    const DepthResponse high(1.0 / 20.0, 200.0, 40.0, LandSettings{});
    EXPECT_NEAR(high.breaking_gain(30.0), 0.78 * 30.0 / 40.0, 1e-12);
    EXPECT_GT(high.untouched(), 51.0);
}

TEST(DepthResponse, PaperGrowthIsGentleAndLimited) {
    LandSettings settings;
    settings.shoaling = Shoaling::paper;
    const DepthResponse response(1.0 / 100.0, 200.0, 1.0, settings);
    EXPECT_NEAR(response.growth(50.0), 1.0, 1e-6);
    EXPECT_EQ(response.growth(50.1), 1.0);
    EXPECT_NEAR(response.growth(25.0), 1.125, 1e-6);
    double before = 1.0;
    for (double depth = 49.0; depth > 1.0; depth -= 1.0) {
        EXPECT_GT(response.growth(depth), before);
        before = response.growth(depth);
    }
    EXPECT_LE(before, 1.25);
}

TEST(DepthResponse, DecreaseFallsSteadilyToWhatTheSettingLeaves) {
    LandSettings settings;
    settings.shoaling = Shoaling::decrease;
    settings.shore_decrease = 1.0;
    settings.breaking_ratio = 0.0;
    const DepthResponse response(1.0 / 100.0, 200.0, 1.0, settings);
    double before = 1.0;
    for (double depth = 49.0; depth > 0.0; depth -= 1.0) {
        EXPECT_LT(response.growth(depth), before);
        before = response.growth(depth);
    }
    EXPECT_NEAR(response.growth(25.0), 0.5, 1e-5);
    EXPECT_NEAR(response.growth(1e-3), 0.0, 1e-4);
    EXPECT_EQ(response.share_limit(5.0), 1.0);
    settings.shoaling = Shoaling::none;
    EXPECT_EQ(DepthResponse(1.0 / 100.0, 200.0, 1.0, settings).growth(2.0), 1.0);
}

TEST(DepthTable, EqualsTheResponse) {
    LandSettings settings;
    for (const double height : {0.1, 3.0, 20.0}) {
        const DepthResponse response(1.0 / 120.0, 60.0, height, settings);
        const DepthTable table(response);
        for (double depth = 0.01; depth < response.untouched(); depth *= 1.0037) {
            const FourFloats row = table.at(static_cast<float>(depth));
            // The kinks, where the water is shallowest or breaking begins, fall within a cell of 1/128.
            EXPECT_NEAR(row[0] / response.wave_number(depth), 1.0, depth > 1.02 ? 1e-5 : 5e-3) << depth;
            EXPECT_NEAR(row[1] / response.growth(depth), 1.0, depth > 1.02 ? 2e-5 : 5e-3) << depth;
            EXPECT_LE(static_cast<double>(row[2]), response.breaking_gain(depth) * 1.000001) << depth;
            EXPECT_NEAR(row[2], response.breaking_gain(depth), 0.01) << depth;
            EXPECT_NEAR(row[3], response.share_limit(depth), 5e-3) << depth;
        }
    }
}

TEST(LandSettings, FaultsNameTheSetting) {
    EXPECT_EQ(land_settings_fault(LandSettings{}), nullptr);
    LandSettings s;
    s.step_log2 = 11;
    EXPECT_NE(std::string(land_settings_fault(s)).find("node step"), std::string::npos);
    s = {};
    s.recovery = std::nan("");
    EXPECT_NE(std::string(land_settings_fault(s)).find("recovery"), std::string::npos);
    s = {};
    s.turn_limit = 1.0;
    EXPECT_NE(std::string(land_settings_fault(s)).find("turn_limit"), std::string::npos);
    s = {};
    s.run_up = std::numeric_limits<double>::infinity();
    EXPECT_NE(std::string(land_settings_fault(s)).find("run_up"), std::string::npos);
    s = {};
    s.shore_decrease = -0.1;
    EXPECT_NE(std::string(land_settings_fault(s)).find("shore_decrease"), std::string::npos);
    s = {};
    s.diffraction = static_cast<Diffraction>(3);
    EXPECT_NE(std::string(land_settings_fault(s)).find("diffraction"), std::string::npos);
    s = {};
    s.shoaling = static_cast<Shoaling>(4);
    EXPECT_NE(std::string(land_settings_fault(s)).find("shoaling"), std::string::npos);
    s = {};
    s.breaking_ratio = 0.0;
    EXPECT_EQ(land_settings_fault(s), nullptr);
}

}  // namespace
}  // namespace trochoid
