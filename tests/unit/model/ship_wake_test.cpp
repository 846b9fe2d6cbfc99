#include "protocol/model/ship_wake.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "protocol/units/hash.hpp"
#include "protocol/units/lattice.hpp"

namespace trochoid {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double gravity = 9.80665;
constexpr double speed = 6.0;  // m/s
constexpr int64_t far_away = INT32_MAX;

double lambda0() { return two_pi * speed * speed / gravity; }

ShipWake wake() {
    ShipWake w;
    w.transverse = 0.5F;
    w.diverging = 0.75F;
    w.choppiness = 1.0F;
    w.inverse_length = static_cast<uint32_t>(std::llround(0x1p40 / (lambda0() * 1024.0)));
    w.group_speed = static_cast<uint32_t>(std::llround(speed / 2.0 * 1024.0 / 1e6 * 0x1p24));
    return w;
}

/// The stationary points t of s(t)(1 - tau t) by bisection of its derivative: the slow truth, without the closed form.
struct Stationary {
    double phase;  // turns at one lambda0 behind
    double t;
};
Stationary stationary(double tau, double low, double high) {
    const auto f = [&](double t) { return std::sqrt(1.0 + t * t) * (1.0 - tau * t); };
    const auto slope = [&](double t) {
        return t * (1.0 - tau * t) / std::sqrt(1.0 + t * t) - tau * std::sqrt(1.0 + t * t);
    };
    const bool rising = slope(high) > slope(low);
    for (int i = 0; i < 200; ++i) {
        const double middle = 0.5 * (low + high);
        ((slope(middle) > 0.0) == rising ? high : low) = middle;
    }
    return {f(low), low};
}

/// Weight of a stationary point by the second derivative over the angle (numerically), softened like the table.
double strength(double tau, double t) {
    const double theta = std::atan(t);
    const auto f = [&](double a) { return (1.0 / std::cos(a)) * (1.0 - tau * std::tan(a)); };
    constexpr double h = 1e-4;
    const double bend = (f(theta + h) - 2.0 * f(theta) + f(theta - h)) / (h * h);
    return 1.0 / std::sqrt(std::abs(bend));
}

struct Place {
    int64_t behind;
    int64_t aside;
    double tau() const { return std::abs(static_cast<double>(aside)) / static_cast<double>(behind); }
    double xi() const { return static_cast<double>(behind) / (lambda0() * 1024.0); }
};

Place place(uint64_t i, double tau_from, double tau_to, int64_t farthest) {
    const auto behind = static_cast<int64_t>(50'000 + splitmix64(i) % static_cast<uint64_t>(farthest));
    const double share = static_cast<double>(splitmix64(~i) % 1'000'000) * 1e-6;
    const auto aside =
        static_cast<int64_t>((tau_from + (tau_to - tau_from) * share) * static_cast<double>(behind));
    return {behind, i % 2 == 0 ? aside : -aside};
}

double turns(uint32_t phase) { return phase / 4294967296.0; }

TEST(ShipWake, PhasesAreThoseOfTheStationaryPoints) {
    double worst_transverse = 0.0;
    double worst_diverging = 0.0;
    for (uint64_t i = 0; i < 4000; ++i) {
        const Place at = place(i, 0.0, 0.352, 1'000'000);
        const WakeSample w = wake_at(wake(), at.behind, at.aside, far_away, 0);
        const double xi = static_cast<double>(at.behind) * wake().inverse_length * 0x1p-40;
        const double cusp = std::sqrt(0.5);
        const Stationary one = stationary(at.tau(), 0.0, cusp);
        const double phase1 = -xi * one.phase - 0.125;
        worst_transverse = std::max(worst_transverse,
                                    std::abs(std::remainder(turns(w.transverse.phase) - phase1, 1.0)) / xi);
        if (at.tau() < 0.13) continue;
        const Stationary two = stationary(at.tau(), cusp, 10.0);
        const double phase2 = -xi * two.phase + 0.125;
        worst_diverging =
            std::max(worst_diverging, std::abs(std::remainder(turns(w.diverging.phase) - phase2, 1.0)) / xi);
    }
    // Turns per lambda0 of distance: the table's chords.
    EXPECT_LE(worst_transverse, 5e-6);
    EXPECT_LE(worst_diverging, 1e-5);
}

TEST(ShipWake, WavesKeepStillInShipAxesByTheDeepWaterRelation) {
    // A wave that stands before the ship has frequency V * k_along, and that must be sqrt(g k).
    const WakeTable& table = wake_table();
    (void)table;
    double worst = 0.0;
    int seen = 0;
    for (uint64_t i = 0; i < 4000; ++i) {
        const Place at = place(i, 0.0, 0.35, 1'000'000);
        const WakeSample s = wake_at(wake(), at.behind, at.aside, far_away, 0);
        for (const WakeWave& w : {s.transverse, s.diverging}) {
            if (w.gain < 1000) continue;
            ++seen;
            const double k = std::hypot(static_cast<double>(w.ku), static_cast<double>(w.kv));
            const double omega = static_cast<double>(wake_speed(wake())) * static_cast<double>(w.ku);
            worst = std::max(worst, std::abs(omega * omega / (gravity * k) - 1.0));
            // It travels along its wave vector, forward and outward.
            const double along = static_cast<double>(w.du) * static_cast<double>(w.ku) / k +
                                 static_cast<double>(w.dv) * static_cast<double>(w.kv) / k;
            EXPECT_GE(along, 0.999);
            EXPECT_GT(w.ku, 0.0F);
            EXPECT_GE(static_cast<double>(w.kv) * static_cast<double>(at.aside), 0.0);
            EXPECT_NEAR(std::hypot(static_cast<double>(w.du), static_cast<double>(w.dv)), 1.0, 5e-4);
        }
    }
    EXPECT_LE(worst, 0.02);
    EXPECT_GT(seen, 4000);
}

TEST(ShipWake, TransverseWavesOnTheAxisAreOneLambda0Long) {
    const WakeSample s = wake_at(wake(), 500'000, 0, far_away, 0);
    const double k = static_cast<double>(s.transverse.ku);
    EXPECT_NEAR(two_pi / k / lambda0(), 1.0, 0.01);
    EXPECT_NEAR(static_cast<double>(s.transverse.kv) / k, 0.0, 1e-3);
    // Crests counted over 20 lambda0 of the surface itself.
    std::vector<double> crests;
    double before = 0.0;
    for (int64_t x = 60'000; x < 60'000 + static_cast<int64_t>(20 * lambda0() * 1024); x += 64) {
        const double now = std::cos(two_pi * turns(wake_at(wake(), x, 0, far_away, 0).transverse.phase));
        if (before < 0.0 && now >= 0.0) crests.push_back(to_metres(x));
        before = now;
    }
    ASSERT_GE(crests.size(), 19U);
    const double mean = (crests.back() - crests.front()) / static_cast<double>(crests.size() - 1);
    EXPECT_NEAR(mean / lambda0(), 1.0, 0.01);
}

TEST(ShipWake, BothSystemsMeetAtTheCuspUnder3526Degrees) {
    const double behind = 600'000;
    const auto aside = static_cast<int64_t>(behind / std::sqrt(8.0));
    const WakeSample s = wake_at(wake(), static_cast<int64_t>(behind), aside, far_away, 0);
    for (const WakeWave& w : {s.transverse, s.diverging}) {
        const double degrees =
            std::atan2(static_cast<double>(w.dv), static_cast<double>(w.du)) * 360.0 / two_pi;
        EXPECT_NEAR(degrees, 35.26, 0.5);
    }
    // A quarter turn apart, as the two stationary points' phases are.
    const double apart = std::remainder(turns(s.diverging.phase) - turns(s.transverse.phase), 1.0);
    EXPECT_NEAR(apart, 0.25, 0.01);
}

TEST(ShipWake, TheWedgeIsKelvins) {
    // Energy over the angle, far behind: the edge is where it falls to half of its crest at the cusp.
    for (const double xi : {5.0, 20.0, 40.0}) {
        const double distance = xi * lambda0() * 1024.0;
        double strongest = 0.0;
        double edge = 0.0;
        double total = 0.0;
        double inside = 0.0;
        for (double degrees = 0.0; degrees < 45.0; degrees += 0.02) {
            const double a = degrees * two_pi / 360.0;
            const WakeSample s = wake_at(wake(), static_cast<int64_t>(distance * std::cos(a)),
                                         static_cast<int64_t>(distance * std::sin(a)), far_away, 0);
            double energy = 0.0;
            for (const WakeWave& w : {s.transverse, s.diverging}) energy += std::pow(w.gain * 0x1p-24, 2.0);
            total += energy;
            if (degrees < 20.47) inside += energy;
            if (energy > strongest) strongest = energy;
            if (energy > 0.5 * strongest) edge = degrees;
        }
        EXPECT_NEAR(edge, 19.47, 1.0) << xi;
        EXPECT_GE(inside / total, 0.999) << xi;
    }
}

TEST(ShipWake, GainsAreTheStationaryPhasesAwayFromTheCusp) {
    for (uint64_t i = 0; i < 500; ++i) {
        const Place at = place(i, 0.0, 0.25, 1'000'000);
        if (at.xi() < 4.0) continue;
        const WakeSample s = wake_at(wake(), at.behind, at.aside, far_away, 0);
        const double t = stationary(at.tau(), 0.0, std::sqrt(0.5)).t;
        const double truth = strength(at.tau(), t) / std::sqrt(at.xi());
        // The softening at the cusp lowers it by some per cent here.
        EXPECT_NEAR(s.transverse.gain * 0x1p-24 / truth, 1.0, 0.1) << at.tau();
    }
    const auto gain = [](double tau) {
        const WakeSample s = wake_at(wake(), 400'000, static_cast<int64_t>(tau * 400'000.0), far_away, 0);
        return std::pair(s.transverse.gain, s.diverging.gain);
    };
    EXPECT_GT(gain(0.35).first, gain(0.1).first);
    EXPECT_GT(gain(0.35).second, gain(0.25).second);
    EXPECT_GT(gain(0.25).second, gain(0.2).second);
    EXPECT_EQ(gain(0.12).second, 0U);
    EXPECT_EQ(gain(0.373).first, 0U);
    EXPECT_EQ(gain(0.373).second, 0U);
}

TEST(ShipWake, FallsWithTheRootOfTheDistanceAndStandsBetweenFrontAndRear) {
    const auto on_axis = [](int64_t behind, int64_t rear = far_away, int64_t front = 0) {
        return wake_at(wake(), behind, 0, rear, front).transverse.gain * 0x1p-24;
    };
    const auto unit = static_cast<int64_t>(std::llround(lambda0() * 1024.0));
    EXPECT_NEAR(on_axis(unit), 0.5, 1e-3);  // half way up the rise
    for (const int64_t n : {2, 3, 4, 5, 9, 16, 33, 64, 100, 900})
        EXPECT_NEAR(on_axis(n * unit), 1.0 / std::sqrt(static_cast<double>(n)), 2e-4) << n;
    EXPECT_EQ(on_axis(0), 0.0);
    EXPECT_EQ(on_axis(-5), 0.0);
    EXPECT_LE(on_axis(1), 1e-4);
    EXPECT_EQ(on_axis(10 * unit, 10 * unit), 0.0);
    EXPECT_EQ(on_axis(10 * unit, 11 * unit + 1), on_axis(10 * unit));
    EXPECT_NEAR(on_axis(10 * unit, 10 * unit + unit / 2) / on_axis(10 * unit), 0.5, 1e-3);
    EXPECT_EQ(on_axis(10 * unit, far_away, 10 * unit), 0.0);
    EXPECT_NEAR(on_axis(10 * unit, far_away, 9 * unit) / on_axis(10 * unit), 0.5, 1e-3);
}

TEST(ShipWake, GradientsAreThoseOfTheFunctionAsEvaluated) {
    double worst_gain = 0.0;
    double worst_phase = 0.0;
    double steepest = 0.0;
    for (uint64_t i = 0; i < 6000; ++i) {
        const Place at = place(i, 0.0, 0.374, 400'000);
        const int64_t rear = 450'000;
        const int64_t front = static_cast<int64_t>(splitmix64(i * 7) % 60'000);
        constexpr int64_t step = 64;
        const auto sample = [&](int64_t u, int64_t v) {
            // u grows towards the ship.
            return wake_at(wake(), at.behind - u, at.aside + v, rear, front);
        };
        // A table has kinks: keep the stencil within one cell.
        const auto cell = [&](int64_t u, int64_t v) {
            const Place there{at.behind - u, at.aside + v};
            return static_cast<int>(there.tau() * 2048.0);
        };
        if (cell(step, step) != cell(-step, -step) || cell(step, -step) != cell(-step, step)) continue;
        const WakeSample here = sample(0, 0);
        const WakeSample e = sample(step, 0);
        const WakeSample w = sample(-step, 0);
        const WakeSample s = sample(0, step);
        const WakeSample n = sample(0, -step);
        const double span = 2.0 * to_metres(step);
        const auto check = [&](const WakeWave& c, const WakeWave& pu, const WakeWave& mu, const WakeWave& pv,
                               const WakeWave& mv) {
            if (c.gain == 0 || pu.gain == 0 || mu.gain == 0 || pv.gain == 0 || mv.gain == 0) return;
            const auto rate = [&](uint32_t hi, uint32_t lo) { return (hi * 0x1p-24 - lo * 0x1p-24) / span; };
            worst_gain =
                std::max({worst_gain, std::abs(rate(pu.gain, mu.gain) - static_cast<double>(c.dgain_du)),
                          std::abs(rate(pv.gain, mv.gain) - static_cast<double>(c.dgain_dv))});
            steepest = std::max(steepest, std::abs(static_cast<double>(c.dgain_du)));
            const auto angle = [&](uint32_t hi, uint32_t lo) {
                return two_pi * static_cast<double>(static_cast<int32_t>(hi - lo)) / 4294967296.0 / span;
            };
            worst_phase =
                std::max({worst_phase, std::abs(angle(pu.phase, mu.phase) - static_cast<double>(c.ku)),
                          std::abs(angle(pv.phase, mv.phase) - static_cast<double>(c.kv))});
        };
        check(here.transverse, e.transverse, w.transverse, s.transverse, n.transverse);
        check(here.diverging, e.diverging, w.diverging, s.diverging, n.diverging);
    }
    EXPECT_LE(worst_gain, 1e-4);
    EXPECT_GT(steepest, 0.02);
    EXPECT_LE(worst_phase, 1e-3);  // tau has 24 bits
}

TEST(ShipWake, IsContinuousEverywhere) {
    // Single lattice steps along a row and a column, across the cusp, the axis, cells, and powers of two of the distance.
    const auto height = [](const WakeWave& w) {
        return w.gain * 0x1p-24 * std::cos(two_pi * turns(w.phase));
    };
    double worst = 0.0;
    for (const int64_t from : {1'000LL, 200'000LL, (1LL << 20) - 600, (1LL << 24) - 600, (1LL << 27) - 600}) {
        for (int64_t v = -1200; v <= 1200; ++v) {
            const auto cusp_v = static_cast<int64_t>(static_cast<double>(from) * 0.3536);
            for (const int64_t centre : {int64_t{0}, cusp_v}) {
                const WakeSample a = wake_at(wake(), from, centre + v, far_away, 0);
                const WakeSample b = wake_at(wake(), from, centre + v + 1, far_away, 0);
                worst = std::max({worst, std::abs(height(a.transverse) - height(b.transverse)),
                                  std::abs(height(a.diverging) - height(b.diverging))});
            }
            if (from + v <= 1) continue;
            const WakeSample a = wake_at(wake(), from + v, from / 4, far_away, 0);
            const WakeSample b = wake_at(wake(), from + v + 1, from / 4, far_away, 0);
            worst = std::max({worst, std::abs(height(a.transverse) - height(b.transverse)),
                              std::abs(height(a.diverging) - height(b.diverging))});
        }
    }
    // A lattice unit of the shortest waves (1.44 m) is 0.0043 rad; the envelope starts within two lambda0.
    EXPECT_LE(worst, 0.02);
}

TEST(ShipWake, BoundHoldsAndBadRecordsAreNamed) {
    double highest = 0.0;
    for (uint64_t i = 0; i < 200'000; ++i) {
        const Place at{static_cast<int64_t>(splitmix64(i) % 100'000) + 1,
                       static_cast<int64_t>(splitmix64(~i) % 70'000) - 35'000};
        const WakeSample s = wake_at(wake(), at.behind, at.aside, far_away, 0);
        highest = std::max(highest, s.transverse.gain * 0x1p-24 * static_cast<double>(wake().transverse) +
                                        s.diverging.gain * 0x1p-24 * static_cast<double>(wake().diverging));
    }
    EXPECT_LE(highest, wake_bound(wake()));
    EXPECT_GE(highest, 0.6 * wake_bound(wake()));
    const auto broken = [](auto change) {
        ShipWake w = wake();
        change(w);
        return !validate(w).has_value();
    };
    EXPECT_FALSE(broken([](ShipWake&) {}));
    EXPECT_FALSE(broken([](ShipWake& w) { w = ShipWake{}; }));
    EXPECT_TRUE(broken([](ShipWake& w) { w.transverse = -1.0F; }));
    EXPECT_TRUE(broken([](ShipWake& w) { w.diverging = 33.0F; }));
    EXPECT_TRUE(broken([](ShipWake& w) { w.choppiness = std::nanf(""); }));
    EXPECT_TRUE(broken([](ShipWake& w) { w.inverse_length = 0; }));
    EXPECT_TRUE(broken([](ShipWake& w) { w.inverse_length = (1U << 31) + 1; }));
    EXPECT_TRUE(broken([](ShipWake& w) { w.group_speed = 0; }));
}

}  // namespace
}  // namespace trochoid
