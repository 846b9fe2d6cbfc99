#include "protocol/model/surface_noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

SurfaceNoise three_octaves() {
    SurfaceNoise n;
    n.amplitude = 0.5F;
    n.persistence = 32768;
    n.octaves = 3;
    n.step_log2 = 10;
    n.period_log2 = 20;
    n.seed = 77;
    return n;
}

struct Point {
    LatticePoint p;
    SeaTime t;
};
Point anywhere(uint64_t i) {
    const uint64_t a = splitmix64(i);
    const uint64_t b = splitmix64(a);
    const uint64_t c = splitmix64(b);
    return {{static_cast<int64_t>(a >> 28) - (int64_t{1} << 35),
             static_cast<int64_t>(b >> 28) - (int64_t{1} << 35)},
            {static_cast<int64_t>(c % 630'000'000'000'000ULL) - 315'000'000'000'000}};
}

// The slow twin: doubles, the textbook sum over eight corners with product weights, floor division by std::floor.
uint32_t mix(uint32_t v) {
    v = (v ^ (v >> 16)) * 2146121005U;
    v = (v ^ (v >> 15)) * 2221713035U;
    return v ^ (v >> 16);
}
double quintic(double f) { return f * f * f * (f * (f * 6 - 15) + 10); }
double twin(const SurfaceNoise& n, LatticePoint p, SeaTime t) {
    static constexpr int gradients[16][3] = {
        {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
        {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}, {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}};
    double sum = 0.0;
    double amplitude = static_cast<double>(n.amplitude);
    for (uint32_t octave = 0; octave < n.octaves; ++octave) {
        const double cell = std::exp2(n.step_log2 - static_cast<double>(octave));
        const double period = std::exp2(n.period_log2 - static_cast<double>(octave));
        const double x = static_cast<double>(p.x) / cell;
        const double z = static_cast<double>(p.z) / cell;
        const double s = static_cast<double>(t.us) / period;
        double value = 0.0;
        for (int corner = 0; corner < 8; ++corner) {
            const double cx = std::floor(x) + (corner & 1);
            const double cz = std::floor(z) + ((corner >> 1) & 1);
            const double ct = std::floor(s) + (corner >> 2);
            const double columns = 4294967296.0 / cell;
            const auto wrapped = [&](double c) {
                return static_cast<uint32_t>(c - std::floor(c / columns) * columns);
            };
            const auto layer = static_cast<uint32_t>(static_cast<int64_t>(ct));
            const uint32_t base = mix(layer * 3407524639U + mix(n.seed + octave * 2654435769U));
            const uint32_t h = mix(base + wrapped(cx) * 2376512323U + wrapped(cz) * 3625334849U) >> 28;
            const auto weight = [](double d) { return 1.0 - quintic(std::abs(d)); };
            value += weight(x - cx) * weight(z - cz) * weight(s - ct) *
                     (gradients[h][0] * (x - cx) + gradients[h][1] * (z - cz) + gradients[h][2] * (s - ct));
        }
        sum += amplitude * value;
        amplitude *= n.persistence / 65536.0;
    }
    return sum;
}

TEST(SurfaceNoise, AgreesWithTheTextbookSumAnywhereAndAtAnyTime) {
    double worst = 0.0;
    double highest = 0.0;
    for (uint64_t i = 0; i < 20'000; ++i) {
        const Point at = anywhere(i);
        const auto h = static_cast<double>(noise_at(three_octaves(), at.p, at.t).height);
        worst = std::max(worst, std::abs(h - twin(three_octaves(), at.p, at.t)));
        highest = std::max(highest, std::abs(h));
    }
    EXPECT_LE(worst, 1e-6);
    EXPECT_GT(highest, 0.4);
}

TEST(SurfaceNoise, DerivativesAreThoseOfTheFunctionAsEvaluated) {
    SurfaceNoise n = three_octaves();
    n.step_log2 = 16;
    n.period_log2 = 26;
    double worst = 0.0;
    double worst_dt = 0.0;
    double steepest = 0.0;
    for (uint64_t i = 0; i < 5'000; ++i) {
        const Point at = anywhere(i);
        const NoiseSample s = noise_at(n, at.p, at.t);
        constexpr int64_t step = 128;
        const auto rate = [](float hi, float lo, double span) {
            return (static_cast<double>(hi) - static_cast<double>(lo)) / span;
        };
        const double dx = rate(noise_at(n, {at.p.x + step, at.p.z}, at.t).height,
                               noise_at(n, {at.p.x - step, at.p.z}, at.t).height, 0.25);
        const double dz = rate(noise_at(n, {at.p.x, at.p.z + step}, at.t).height,
                               noise_at(n, {at.p.x, at.p.z - step}, at.t).height, 0.25);
        const double dt =
            rate(noise_at(n, at.p, at.t + 100'000).height, noise_at(n, at.p, at.t - 100'000).height, 0.2);
        worst = std::max(
            {worst, std::abs(dx - static_cast<double>(s.dx)), std::abs(dz - static_cast<double>(s.dz))});
        worst_dt = std::max(worst_dt, std::abs(dt - static_cast<double>(s.dt)));
        steepest = std::max(steepest, std::abs(dx));
    }
    EXPECT_LE(worst, 2e-5);
    EXPECT_LE(worst_dt, 2e-5);
    EXPECT_GT(steepest, 0.02);
}

TEST(SurfaceNoise, HasNoSeamAtCellsNorWhereTheLatticeWraps) {
    double worst = 0.0;
    for (const int64_t border : {int64_t{0}, int64_t{1024}, int64_t{-1024}, int64_t{1} << 31,
                                 int64_t{1} << 32, -(int64_t{1} << 32), int64_t{7} << 32})
        for (uint64_t i = 0; i < 200; ++i) {
            const auto other = static_cast<int64_t>(splitmix64(i) % 100'000);
            const SeaTime t{static_cast<int64_t>(i) * 262'144};
            const auto step = [&](LatticePoint a, LatticePoint b) {
                const NoiseSample s = noise_at(three_octaves(), a, t);
                const NoiseSample e = noise_at(three_octaves(), b, t);
                worst =
                    std::max(worst, std::abs(static_cast<double>(s.height) - static_cast<double>(e.height)));
            };
            step({border - 1, other}, {border, other});
            step({other, border - 1}, {other, border});
            const NoiseSample before = noise_at(three_octaves(), {other, other}, {(border << 8) - 1});
            const NoiseSample after = noise_at(three_octaves(), {other, other}, {border << 8});
            worst = std::max(
                worst, std::abs(static_cast<double>(before.height) - static_cast<double>(after.height)));
        }
    // A step is 1/1024 of the coarsest cell, 1/256 of the finest.
    EXPECT_LE(worst, 4e-3);
}

TEST(SurfaceNoise, RepeatsAfter4194KilometresAsTheWavesDo) {
    for (uint64_t i = 0; i < 100; ++i) {
        const LatticePoint p{static_cast<int64_t>(splitmix64(i) % 1'000'000), 5};
        EXPECT_EQ(noise_at(three_octaves(), p, {9}),
                  noise_at(three_octaves(), {p.x + (int64_t{1} << 32), p.z - (int64_t{1} << 32)}, {9}));
    }
}

TEST(SurfaceNoise, BoundHoldsForEveryChoiceOfGradients) {
    // The most that any gradients can give at a place in the cell: each corner's best, by the two largest components.
    double most = 0.0;
    constexpr int n = 80;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j)
            for (int k = 0; k <= n; ++k) {
                const double f[3] = {i / double{n}, j / double{n}, k / double{n}};
                double sum = 0.0;
                for (int corner = 0; corner < 8; ++corner) {
                    double weight = 1.0;
                    double d[3];
                    for (int axis = 0; axis < 3; ++axis) {
                        d[axis] = std::abs(f[axis] - ((corner >> axis) & 1));
                        weight *= 1.0 - quintic(d[axis]);
                    }
                    sum += weight * (d[0] + d[1] + d[2] - std::min({d[0], d[1], d[2]}));
                }
                most = std::max(most, sum);
            }
    SurfaceNoise one = three_octaves();
    one.octaves = 1;
    one.amplitude = 1.0F;
    // Between grid points the sum can rise by its slope (below 8 a cell) times half a grid step's diagonal at worst near
    // the maximum, where it is flat: a thousandth.
    EXPECT_LE(most + 1e-3, noise_bound(one));
    EXPECT_GE(most, 0.95 * noise_bound(one));
    EXPECT_NEAR(noise_bound(three_octaves()), 0.5 * 1.75 * noise_bound(one), 1e-9);
}

TEST(SurfaceNoise, UsesEverySideOfTheGradientsEvenly) {
    // Mean 0 and equal slopes along both axes over many cells: a biased hash would show.
    double mean = 0.0;
    double xx = 0.0;
    double zz = 0.0;
    constexpr int count = 40'000;
    for (uint64_t i = 0; i < count; ++i) {
        const Point at = anywhere(i);
        const NoiseSample s = noise_at(three_octaves(), at.p, at.t);
        mean += static_cast<double>(s.height) / count;
        xx += static_cast<double>(s.dx) * static_cast<double>(s.dx) / count;
        zz += static_cast<double>(s.dz) * static_cast<double>(s.dz) / count;
    }
    EXPECT_NEAR(mean, 0.0, 0.003);
    EXPECT_NEAR(xx / zz, 1.0, 0.05);
}

TEST(SurfaceNoise, OctavesThatNobodySeesAreLeftOut) {
    SurfaceNoise n = three_octaves();
    EXPECT_EQ(octaves_at(n, {0}).size(), 3U);
    n.persistence = 1;
    EXPECT_EQ(octaves_at(n, {0}).size(), 2U);
    n.amplitude = 0.0F;
    EXPECT_EQ(octaves_at(n, {0}).size(), 0U);
    EXPECT_EQ(noise_at(n, {3, 4}, {5}), NoiseSample{});
}

TEST(SurfaceNoise, BadRecordsAreNamed) {
    const auto broken = [](auto change) {
        SurfaceNoise n = three_octaves();
        change(n);
        return !validate(n).has_value();
    };
    EXPECT_FALSE(broken([](SurfaceNoise&) {}));
    EXPECT_TRUE(validate(SurfaceNoise{}).has_value());
    EXPECT_TRUE(broken([](SurfaceNoise& n) { n.amplitude = 33.0F; }));
    EXPECT_TRUE(broken([](SurfaceNoise& n) { n.amplitude = -0.0F; }));
    EXPECT_TRUE(broken([](SurfaceNoise& n) { n.amplitude = std::nanf(""); }));
    EXPECT_TRUE(broken([](SurfaceNoise& n) { n.octaves = 0; }));
    EXPECT_TRUE(broken([](SurfaceNoise& n) { n.octaves = 13; }));
    EXPECT_TRUE(broken([](SurfaceNoise& n) { n.octaves = 8; }));  // 2^10 halved seven times is 2^3
    EXPECT_TRUE(broken([](SurfaceNoise& n) { n.step_log2 = 21; }));
    EXPECT_TRUE(broken([](SurfaceNoise& n) { n.period_log2 = 13; }));
    EXPECT_TRUE(broken([](SurfaceNoise& n) { n.period_log2 = 41; }));
}

}  // namespace
}  // namespace trochoid
