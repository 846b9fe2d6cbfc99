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

double radians(uint32_t turns) { return tau * static_cast<double>(turns) / 4294967296.0; }

/// k . x + phase - omega T in exact 128-bit integers.
uint32_t exact_turns(int32_t kx, int32_t kz, uint64_t omega, uint32_t phase, LatticePoint p, SeaTime t) {
    const auto place = Wide{kx} * p.x + Wide{kz} * p.z;
    const auto time = (Wide{static_cast<int64_t>(omega)} * t.us) >> 32;
    return static_cast<uint32_t>(place) - static_cast<uint32_t>(time) + phase;
}

/// The slow, obvious twin: doubles, std::sin, the exact quantised wave; the paper's formulas for irregular heights and round waves.
/// Envelope, land field, wake and noise have twins of their own.
TwinSum twin(const Sea& sea, SeaTime t, LatticePoint p) {
    TwinSum sum;
    for (const auto& box : sea.boxes()) {
        const WaveTrainBox& b = box->record;
        const BoxInstant now = instant_of(b, t);
        const Envelope e = envelope_at(b, now, p);
        const double envelope = static_cast<double>(e.gain) / 16777216.0;
        if (e.gain == 0) continue;
        const IrregularHeight& i = b.irregular;
        const double modulation =
            1.0 - i.share / 32768.0 * std::sin(radians(exact_turns(i.ukx, i.ukz, i.omega, i.phase_u, p, t))) *
                      std::sin(radians(exact_turns(i.vkx, i.vkz, 0, i.phase_v, p, t)));
        const double off = (b.width != 0 ? static_cast<double>(box_position(b, now, p).v) : 0.0) -
                           static_cast<double>(b.width) / 2;
        for (size_t n = 0; n < b.trains.size(); ++n) {
            const WaveTrain& w = b.trains[n];
            const LandSample land = box->field_of_train[n] < 0
                                        ? LandSample{}
                                        : box->fields[static_cast<size_t>(box->field_of_train[n])]->sample(p);
            const double k = std::hypot(static_cast<double>(w.kx), static_cast<double>(w.kz));
            // The wave number is a whole number here, and so is 2^40 / width.
            const double lag = b.roundness == 0
                                   ? 0.0
                                   : std::floor(std::floor(k) * b.roundness / 32768.0) / 4294967296.0 * off *
                                         off * std::floor(0x1p40 / static_cast<double>(b.width)) * 0x1p-40;
            const double phase =
                radians(exact_turns(w.kx, w.kz, w.omega, w.phase, p, t) + land.shift) + tau * lag;
            const double g = envelope * static_cast<double>(land.gain) / 16777216.0 * modulation;
            const double a = static_cast<double>(w.amplitude);
            const double h = a * static_cast<double>(w.choppiness) * static_cast<double>(land.orbit);
            sum.ax += h * w.kx / k * g * std::sin(phase);
            sum.az += h * w.kz / k * g * std::sin(phase);
            sum.ay += a * g * std::cos(phase);
        }
        if (has_wake(b.wake)) {
            const BoxPosition at = box_position(b, now, p);
            const WakeSample wake =
                wake_at(b.wake, b.length - at.u, at.v - b.width / 2, now.wake_rear, now.wake_front);
            const double ux = b.ux / 1073741824.0;
            const double uz = b.uz / 1073741824.0;
            const auto add = [&](const WakeWave& w, float amplitude) {
                const double a = static_cast<double>(amplitude) * envelope * w.gain / 16777216.0;
                const double h = a * static_cast<double>(b.wake.choppiness) * std::sin(radians(w.phase));
                const auto du = static_cast<double>(w.du);
                const auto dv = static_cast<double>(w.dv);
                sum.ax += h * (du * ux - dv * uz);
                sum.az += h * (du * uz + dv * ux);
                sum.ay += a * std::cos(radians(w.phase));
            };
            add(wake.transverse, b.wake.transverse);
            add(wake.diverging, b.wake.diverging);
        }
        if (!b.noise.displayed_only) sum.ay += envelope * static_cast<double>(noise_at(b.noise, p, t).height);
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
    for (const int64_t us :
         {0LL, 100'000'000LL, 230'000'000LL, 700'000'000LL, 5'000'000'000LL, 315'000'000'000'000LL})
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
    // The other features: sea_features_test.cpp.
    const Sea whole = reference_sea();
    const Sea sea({whole.boxes()[0], whole.boxes()[1]});
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
    const Sea reference = reference_sea();
    const Sea whole({reference.boxes()[0], reference.boxes()[1]});
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
    const Sea turned(
        {sea.boxes()[1], sea.boxes()[4], sea.boxes()[0], sea.boxes()[5], sea.boxes()[3], sea.boxes()[2]});
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
    const Sea whole = reference_sea();
    const Sea sea({whole.boxes()[0], whole.boxes()[1]});
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

TEST(SelfCheck, TheSeaOfModelVersion1IsStillTheSameToTheBit) {
    // Boxes 1 and 2 are all that version 1 had; this is its published self-check hash.
    const Sea sea = reference_sea();
    EXPECT_EQ(hash_over(Sea({sea.boxes()[0], sea.boxes()[1]}), 2004, 512), 0xe789e676af1f166fU);
}

}  // namespace
}  // namespace trochoid
