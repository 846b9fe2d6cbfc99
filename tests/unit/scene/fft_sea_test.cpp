// The Fourier tile: as high as asked for, its derivatives those of its heights, its waves travelling where they should.
#include "client/scene/fft_sea.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace trochoid {
namespace {

FftSeaSettings settings_of(float height, glm::vec2 heading) {
    FftSeaSettings settings;
    settings.side = 128;
    settings.tile_log2 = 18;
    settings.significant_height = height;
    settings.heading = heading;
    return settings;
}

constexpr int side = 128;
constexpr float sample_m = 2.0F;
size_t at(int column, int row) {
    return static_cast<size_t>((row + side) % side * side + (column + side) % side);
}

TEST(FftSea, is_as_high_as_asked_for) {
    for (const float height : {0.5F, 1.0F, 2.0F}) {
        FftSea sea(settings_of(height, {1, 0}));
        double squares = 0;
        int samples = 0;
        for (int moment = 0; moment < 20; ++moment) {
            sea.transform(moment * 7.3);
            for (const glm::vec4& d : sea.displaced())
                squares += static_cast<double>(d.y) * static_cast<double>(d.y), ++samples;
        }
        EXPECT_NEAR(4 * std::sqrt(squares / samples), static_cast<double>(height),
                    0.04 * static_cast<double>(height));
    }
}

TEST(FftSea, slopes_and_gradients_are_the_derivatives_of_its_fields) {
    FftSea sea(settings_of(1.5F, {0.6F, 0.8F}));
    sea.transform(12.5);
    const auto d = sea.displaced();
    const auto s = sea.slopes();
    // A central difference over two samples shows a wave of length l too flat by sin(x)/x, x = 2 pi sample/l: most of the energy
    // lies above 8 samples.
    double slope_error = 0, slope_power = 0, fold_error = 0, fold_power = 0, cross_error = 0, cross_power = 0;
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column) {
            const auto across = [&](int component) {
                return (d[at(column + 1, row)][component] - d[at(column - 1, row)][component]) /
                       (2 * sample_m);
            };
            const auto down = [&](int component) {
                return (d[at(column, row + 1)][component] - d[at(column, row - 1)][component]) /
                       (2 * sample_m);
            };
            const auto add = [](double& error, double& power, float approximate, float exact) {
                error += std::pow(static_cast<double>(approximate - exact), 2);
                power += std::pow(static_cast<double>(exact), 2);
            };
            add(slope_error, slope_power, across(1), s[at(column, row)].x);
            add(slope_error, slope_power, down(1), s[at(column, row)].y);
            add(fold_error, fold_power, across(0), s[at(column, row)].z);
            add(fold_error, fold_power, down(2), s[at(column, row)].w);
            add(cross_error, cross_power, down(0), d[at(column, row)].w);
        }
    EXPECT_LT(std::sqrt(slope_error / slope_power), 0.45);
    EXPECT_LT(std::sqrt(fold_error / fold_power), 0.45);
    EXPECT_LT(std::sqrt(cross_error / cross_power), 0.45);
    EXPECT_GT(sea.slope_variance()[0], sea.slope_variance()[2]);
    EXPECT_NEAR(slope_power / (side * side), static_cast<double>(sea.slope_variance()[0]),
                0.1 * slope_power / (side * side));
}

TEST(FftSea, waves_travel_towards_the_heading) {
    FftSea sea(settings_of(1.0F, {1, 0}));
    sea.transform(100.0);
    const std::vector<glm::vec4> before(sea.displaced().begin(), sea.displaced().end());
    sea.transform(100.4);
    const auto after = sea.displaced();
    const auto correlation = [&](int shift) {
        double sum = 0;
        for (int row = 0; row < side; ++row)
            for (int column = 0; column < side; ++column)
                sum += static_cast<double>(before[at(column, row)].y) *
                       static_cast<double>(after[at(column + shift, row)].y);
        return sum;
    };
    int best = -8;
    for (int shift = -8; shift <= 8; ++shift)
        if (correlation(shift) > correlation(best)) best = shift;
    // Waves of 39 m run 7.8 m/s: 3.1 m in 0.4 s are one to two samples of 2 m.
    EXPECT_GE(best, 1);
    EXPECT_LE(best, 3);
}

/// Orbits sharpen crests: the surface converges where it is high.
TEST(FftSea, crests_are_sharp) {
    FftSea sea(settings_of(1.0F, {1, 0}));
    sea.transform(3.0);
    double together = 0;
    for (size_t i = 0; i < sea.displaced().size(); ++i)
        together += static_cast<double>(sea.displaced()[i].y) *
                    static_cast<double>(sea.slopes()[i].z + sea.slopes()[i].w);
    EXPECT_GT(together, 0.0);
}

TEST(FftSea, peak_of_a_risen_sea) {
    // 15 m/s at 19.5 m: Hs = 4.8 m, peak at 0.877 g / U (Stewart): 11 s, 188 m.
    EXPECT_NEAR(peak_period_of(4.816), 10.95, 0.1);
    EXPECT_NEAR(peak_wavelength_of(4.816), 187.5, 3.0);
}

}  // namespace
}  // namespace trochoid
