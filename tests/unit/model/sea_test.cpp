#include "protocol/model/sea.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "protocol/model/point_query.hpp"
#include "protocol/model/self_check.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

__extension__ typedef __int128 Wide;

constexpr double tau = 2.0 * std::numbers::pi;

struct TwinSum {
    double ax = 0.0, ay = 0.0, az = 0.0;
};

/// The slow, obvious twin: doubles, std::sin, the exact quantised wave.
TwinSum twin(const Sea& sea, SeaTime t, LatticePoint p) {
    TwinSum sum;
    for (const auto& box : sea.boxes()) {
        const WaveTrainBox& b = box->record;
        const Envelope e = envelope_at(b, instant_of(b, t), p);
        for (size_t i = 0; i < b.trains.size(); ++i) {
            const WaveTrain& w = b.trains[i];
            const LandSample land = box->field_of_train[i] < 0
                                        ? LandSample{}
                                        : box->fields[static_cast<size_t>(box->field_of_train[i])]->sample(p);
            // Phase in exact 128-bit integers, then one conversion.
            const auto place = Wide{w.kx} * p.x + Wide{w.kz} * p.z;
            const auto time = (Wide{static_cast<int64_t>(w.omega)} * t.us) >> 32;
            const auto turns =
                static_cast<uint32_t>(place) - static_cast<uint32_t>(time) + w.phase + land.shift;
            const double phase = tau * static_cast<double>(turns) / 4294967296.0;
            const double g =
                static_cast<double>(e.gain) / 16777216.0 * static_cast<double>(land.gain) / 16777216.0;
            const double n = std::hypot(static_cast<double>(w.kx), static_cast<double>(w.kz));
            const double a = static_cast<double>(w.amplitude);
            const double h = a * static_cast<double>(w.choppiness);
            sum.ax += h * w.kx / n * g * std::sin(phase);
            sum.az += h * w.kz / n * g * std::sin(phase);
            sum.ay += a * g * std::cos(phase);
        }
    }
    return sum;
}

LatticePoint some_point(uint64_t i, int64_t span) {
    const uint64_t a = splitmix64(i);
    const uint64_t b = splitmix64(a);
    return {static_cast<int64_t>(a % static_cast<uint64_t>(span)) - span / 2,
            static_cast<int64_t>(b % static_cast<uint64_t>(span)) - span / 2};
}

TEST(Sea, AgreesWithTheDoubleTwinAtAnyTimeAndPlace) {
    const Sea sea = reference_sea();
    double worst = 0.0;
    double largest = 0.0;
    for (const int64_t us : {0LL, 100'000'000LL, 5'000'000'000LL, 315'000'000'000'000LL})
        for (uint64_t i = 0; i < 500; ++i) {
            const LatticePoint p = some_point(i, i % 5 == 0 ? 40'000'000'000 : 4'000'000);
            const SurfaceSample s = SeaInstant(sea, {us}).evaluate(p);
            const TwinSum d = twin(sea, {us}, p);
            worst = std::max({worst, std::abs(static_cast<double>(s.ax) - d.ax),
                              std::abs(static_cast<double>(s.ay) - d.ay),
                              std::abs(static_cast<double>(s.az) - d.az)});
            largest = std::max(largest, std::abs(d.ay));
        }
    EXPECT_LE(worst, 2e-6);
    EXPECT_GT(largest, 1.0);
}

TEST(Sea, DerivativesAreThoseOfTheFunctionAsEvaluated) {
    // Central differences over 2 m steps on waves of 60 m and more, inside fields, ramps and growth; a wrong term of
    // refraction or of a gradient would show as some per cent.
    const Sea sea = reference_sea();
    const SeaInstant instant(sea, {400'000'000});
    double worst = 0.0;
    double worst_without_land = 0.0;
    for (uint64_t i = 0; i < 3000; ++i) {
        const LatticePoint p = some_point(i, 1'500'000);
        // Keep off cell borders, where a bilinear field has a kink.
        if (((p.x & 65535) < 4096) || ((p.x & 65535) > 61440) || ((p.z & 65535) < 4096) ||
            ((p.z & 65535) > 61440))
            continue;
        const SurfaceSample s = instant.evaluate(p);
        constexpr int64_t step = 512;
        const SurfaceSample e = instant.evaluate({p.x + step, p.z});
        const SurfaceSample w = instant.evaluate({p.x - step, p.z});
        const SurfaceSample n = instant.evaluate({p.x, p.z - step});
        const SurfaceSample south = instant.evaluate({p.x, p.z + step});
        const double span = 2.0 * to_metres(step);
        const auto slope = [span](float hi, float lo) {
            return (static_cast<double>(hi) - static_cast<double>(lo)) / span;
        };
        const double errors[] = {slope(e.ay, w.ay) - static_cast<double>(s.yx),
                                 slope(south.ay, n.ay) - static_cast<double>(s.yz),
                                 (1.0 - slope(e.ax, w.ax)) - static_cast<double>(s.pxx),
                                 -slope(south.ax, n.ax) - static_cast<double>(s.pxz),
                                 -slope(e.az, w.az) - static_cast<double>(s.pzx),
                                 (1.0 - slope(south.az, n.az)) - static_cast<double>(s.pzz)};
        for (const double error : errors) worst = std::max(worst, std::abs(error));
        worst_without_land = std::max(worst_without_land, std::abs(static_cast<double>(s.yx)));
    }
    EXPECT_LE(worst, 2e-3);
    EXPECT_GT(worst_without_land, 0.05) << "slopes too small to prove anything";
}

TEST(Sea, ASupersetOfBoxesAndBlocksChangesNoBit) {
    const Sea whole = reference_sea();
    // The wind box reaches nowhere near this place, so leaving it out changes nothing.
    const Sea part({whole.boxes()[0]});
    const SeaTime t{500'000'000};
    for (uint64_t i = 0; i < 200; ++i) {
        LatticePoint p = some_point(i, 1'000'000);
        p.x += 50'000'000;
        EXPECT_EQ(SeaInstant(whole, t).evaluate(p), SeaInstant(part, t).evaluate(p));
    }
}

TEST(Sea, OrderOfBoxesDoesNotMatter) {
    const Sea sea = reference_sea();
    const Sea turned({sea.boxes()[1], sea.boxes()[0]});
    const LatticePoint p{1234, 99'000};
    EXPECT_EQ(SeaInstant(sea, {10'000'000'000}).evaluate(p),
              SeaInstant(turned, {10'000'000'000}).evaluate(p));
}

TEST(Sea, TwiceTheSameBoxIsOurBug) {
    const Sea sea = reference_sea();
    EXPECT_DEATH(Sea({sea.boxes()[0], sea.boxes()[0]}), "assertion failed");
}

TEST(Sea, StillWaterIsFlat) {
    const SurfaceSample s = SeaInstant(Sea(), {7}).evaluate({3, 4});
    EXPECT_EQ(s, SurfaceSample{});
}

TEST(WaterAt, FindsTheSurfaceAboveTheGivenPlace) {
    const Sea sea = reference_sea();
    const SeaInstant instant(sea, {5'000'000'000});
    for (uint64_t i = 0; i < 1000; ++i) {
        const LatticePoint place = some_point(i, 3'000'000);
        const WaterPoint w = water_at(instant, place);
        const SurfaceSample s = instant.evaluate(w.rest);
        EXPECT_LE(std::abs(to_metres(w.rest.x - place.x) - static_cast<double>(s.ax)), 0.001);
        EXPECT_LE(std::abs(to_metres(w.rest.z - place.z) - static_cast<double>(s.az)), 0.001);
        EXPECT_EQ(w.height, s.ay);
        EXPECT_NEAR(static_cast<double>(w.nx * w.nx + w.ny * w.ny + w.nz * w.nz), 1.0, 1e-6);
    }
}

TEST(WaterAt, VelocityIsTheDerivativeOfTheParticle) {
    const Sea sea = reference_sea();
    const LatticePoint p{20'000, -30'000};
    const SeaTime t{5'000'000'000};
    const SurfaceSample s = SeaInstant(sea, t).evaluate(p);
    const SurfaceSample before = SeaInstant(sea, t - 10'000).evaluate(p);
    const SurfaceSample after = SeaInstant(sea, t + 10'000).evaluate(p);
    EXPECT_NEAR(static_cast<double>(s.vy), static_cast<double>(after.ay - before.ay) / 0.02, 2e-3);
    EXPECT_NEAR(static_cast<double>(s.vx), -static_cast<double>(after.ax - before.ax) / 0.02, 2e-3);
    EXPECT_NEAR(static_cast<double>(s.vz), -static_cast<double>(after.az - before.az) / 0.02, 2e-3);
}

TEST(SelfCheck, ThisBuildComputesTheNormativeSea) {
    EXPECT_NO_THROW(self_check());
    EXPECT_NE(reference_hash(1, 100), reference_hash(2, 100));
}

}  // namespace
}  // namespace trochoid
