#include <gtest/gtest.h>

#include <cmath>

#include "protocol/model/point_query.hpp"
#include "protocol/model/self_check.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

WaveTrainBox record_of(size_t box) { return reference_sea().boxes()[box]->record; }

/// Land with smooth hills of shift, gain and orbit, nodes of 64 m, over +-2 km.
std::shared_ptr<const LandField> hills() {
    auto field = std::make_shared<LandField>(FieldId{2}, uint8_t{16});
    for (int32_t bz = -2; bz < 2; ++bz)
        for (int32_t bx = -2; bx < 2; ++bx) {
            auto block = std::make_shared<LandBlock>();
            block->key = {bx, bz};
            for (int z = 0; z < block_nodes; ++z)
                for (int x = 0; x < block_nodes; ++x) {
                    const int nx = bx * block_cells + x;
                    const int nz = bz * block_cells + z;
                    const auto i = static_cast<size_t>(z * block_nodes + x);
                    block->shift[i] = (nx * nx - 2 * nz * nx) * 400;
                    block->gain[i] = static_cast<uint16_t>(30'000 + 300 * nx - 100 * nz);
                    block->orbit[i] = static_cast<uint16_t>(30'000 - 250 * nx + 150 * nz);
                }
            field->set(std::move(block));
        }
    return field;
}

/// Every feature of a box at once, long waves so that differences over a metre are good.
WaveTrainBox everything() {
    WaveTrainBox b = record_of(2);
    b.overlays.clear();
    b.gain_max = 65'535;
    for (WaveTrain& t : b.trains) t.field = {2};
    b.trains[2].field = {0};
    b.noise.step_log2 = 16;
    b.noise.period_log2 = 24;
    b.noise.amplitude = 1.0F;
    return b;
}

Sea everything_sea() {
    const std::shared_ptr<const LandField> fields[] = {hills()};
    return Sea({prepare(everything(), fields)});
}

LatticePoint some_point(uint64_t i, int64_t span) {
    const uint64_t a = splitmix64(i);
    const uint64_t b = splitmix64(a);
    return {static_cast<int64_t>(a % static_cast<uint64_t>(span)) - span / 2,
            static_cast<int64_t>(b % static_cast<uint64_t>(span)) - span / 2};
}

double wide(float v) { return static_cast<double>(v); }

/// Largest difference between the derivatives told and central differences over +-`step`, and the largest told.
struct Slopes {
    double error = 0.0;
    double largest = 0.0;
};
Slopes slopes_at(const SeaInstant& sea, LatticePoint p, int64_t step) {
    const SurfaceSample s = sea.evaluate(p);
    const SurfaceSample e = sea.evaluate({p.x + step, p.z});
    const SurfaceSample w = sea.evaluate({p.x - step, p.z});
    const SurfaceSample n = sea.evaluate({p.x, p.z - step});
    const SurfaceSample south = sea.evaluate({p.x, p.z + step});
    const double span = 2.0 * to_metres(step);
    const auto rate = [span](float hi, float lo) { return (wide(hi) - wide(lo)) / span; };
    Slopes out;
    for (const double error : {rate(e.ay, w.ay) - wide(s.yx), rate(south.ay, n.ay) - wide(s.yz),
                               (1.0 - rate(e.ax, w.ax)) - wide(s.pxx), -rate(south.ax, n.ax) - wide(s.pxz),
                               -rate(e.az, w.az) - wide(s.pzx), (1.0 - rate(south.az, n.az)) - wide(s.pzz)})
        out.error = std::max(out.error, std::abs(error));
    out.largest = std::max(std::abs(wide(s.yx)), std::abs(wide(s.yz)));
    return out;
}

TEST(Features, DerivativesHoldWithLandRoundWavesIrregularHeightsOrbitsAndNoiseTogether) {
    const SeaInstant sea(everything_sea(), {250'000'000});
    double worst = 0.0;
    double steepest = 0.0;
    int seen = 0;
    for (uint64_t i = 0; i < 6000; ++i) {
        const LatticePoint p = some_point(i, 4'000'000);
        const auto near_border = [](int64_t v) { return (v & 65535) < 1024 || (v & 65535) > 64512; };
        if (near_border(p.x) || near_border(p.z)) continue;
        const Slopes s = slopes_at(sea, p, 256);
        if (s.largest == 0.0) continue;
        // A ramp's foot is a kink.
        const Envelope e = envelope_at(everything(), instant_of(everything(), {250'000'000}), p);
        if (e.gain == 0) continue;
        ++seen;
        worst = std::max(worst, s.error);
        steepest = std::max(steepest, s.largest);
    }
    EXPECT_GT(seen, 800);
    EXPECT_GT(steepest, 0.08);
    EXPECT_LE(worst, 4e-4);
}

TEST(Features, EachGradientTermIsNeeded) {
    // The same with one feature at a time: that each one's term counts shows in the sea without it being another.
    const Sea sea = everything_sea();
    const SeaTime t{250'000'000};
    const SeaInstant all(sea, t);
    for (const Layer layer : {Layer::trains, Layer::shelter, Layer::refraction, Layer::irregular,
                              Layer::orbits, Layer::round, Layer::noise}) {
        const SeaInstant without(sea, t, authoritative_layers.without(layer));
        double changed = 0.0;
        double worst = 0.0;
        for (uint64_t i = 0; i < 500; ++i) {
            const LatticePoint p = some_point(i, 2'000'000);
            const auto near_border = [](int64_t v) { return (v & 65535) < 1024 || (v & 65535) > 64512; };
            if (near_border(p.x) || near_border(p.z)) continue;
            changed =
                std::max(changed, std::abs(wide(all.evaluate(p).pxx) - wide(without.evaluate(p).pxx)) +
                                      std::abs(wide(all.evaluate(p).yx) - wide(without.evaluate(p).yx)));
            worst = std::max(worst, slopes_at(without, p, 256).error);
        }
        EXPECT_GT(changed, 0.004) << static_cast<int>(layer);
        EXPECT_LE(worst, 4e-4) << static_cast<int>(layer);
    }
}

TEST(Features, WakeDerivativesHoldWithinTheTablesCells) {
    const Sea sea({prepare(record_of(3), {})});
    const SeaTime t{300'000'000};
    const SeaInstant instant(sea, t);
    const WaveTrainBox& b = sea.boxes()[0]->record;
    const BoxInstant now = instant_of(b, t);
    double worst = 0.0;
    double steepest = 0.0;
    int seen = 0;
    for (uint64_t i = 0; i < 20'000; ++i) {
        LatticePoint p = some_point(i, 3'000'000);
        const auto cell = [&](LatticePoint at) {
            const BoxPosition place = box_position(b, now, at);
            return std::floor(2048.0 * std::abs(static_cast<double>(place.v - b.width / 2)) /
                              static_cast<double>(b.length - place.u));
        };
        constexpr int64_t step = 48;
        if (cell({p.x - step, p.z}) != cell({p.x + step, p.z}) ||
            cell({p.x, p.z - step}) != cell({p.x, p.z + step}))
            continue;
        const Slopes s = slopes_at(instant, p, step);
        if (s.largest == 0.0) continue;
        ++seen;
        worst = std::max(worst, s.error);
        steepest = std::max(steepest, s.largest);
    }
    EXPECT_GT(seen, 300);
    EXPECT_GT(steepest, 0.02);
    EXPECT_LE(worst, 2e-3);  // tau has 24 bits: a step of its phase within 5 cm
}

TEST(Features, TheWakeRidesWithItsShip) {
    // In ship axes it stands: the same picture a minute later where the ship has gone, but for its growing end.
    const WaveTrainBox ship = record_of(3);
    const Sea sea({prepare(ship, {})});
    const SeaTime t{100'000'000};
    const LatticePoint before = instant_of(ship, t).origin;
    const LatticePoint after = instant_of(ship, t + 60'000'000).origin;
    double highest = 0.0;
    for (uint64_t i = 0; i < 3000; ++i) {
        // Around the 500 m behind the ship's place.
        const int64_t u = ship.length - static_cast<int64_t>(splitmix64(i) % 512'000);
        const int64_t v = ship.width / 2 + static_cast<int64_t>(splitmix64(~i) % 200'000) - 100'000;
        const LatticePoint p{before.x + ((u * ship.ux - v * ship.uz) >> 30),
                             before.z + ((u * ship.uz + v * ship.ux) >> 30)};
        const SurfaceSample s = SeaInstant(sea, t).evaluate(p);
        const SurfaceSample later =
            SeaInstant(sea, t + 60'000'000).evaluate({p.x + after.x - before.x, p.z + after.z - before.z});
        EXPECT_EQ(s, later);
        highest = std::max(highest, std::abs(wide(s.ay)));
    }
    EXPECT_GT(highest, 0.2);
}

TEST(Features, TheWakesWedgeMeasuredOnTheSurfaceIsKelvins) {
    // Mean square of the height along rays from the ship, 10 to 30 lambda0 behind it: half of its crest is the wedge's edge.
    const WaveTrainBox b = record_of(3);
    const SeaTime t{400'000'000};
    const SeaInstant sea(Sea({prepare(b, {})}), t);
    const LatticePoint corner = instant_of(b, t).origin;
    for (const double side : {-1.0, 1.0}) {
        double strongest = 0.0;
        double edge = 0.0;
        for (double degrees = 10.0; degrees < 30.0; degrees += 0.1) {
            const double angle = degrees * 0.017453292519943295;
            double energy = 0.0;
            for (double r = 236'000; r < 709'000; r += 1'531) {
                const auto u = b.length - static_cast<int64_t>(r * std::cos(angle));
                const auto v = b.width / 2 + static_cast<int64_t>(side * r * std::sin(angle));
                const double y = wide(sea.evaluate({corner.x + ((u * b.ux - v * b.uz) >> 30),
                                                    corner.z + ((u * b.uz + v * b.ux) >> 30)})
                                          .ay);
                energy += y * y;
            }
            strongest = std::max(strongest, energy);
            if (energy > 0.5 * strongest) edge = degrees;
        }
        EXPECT_GT(strongest, 0.1);
        EXPECT_NEAR(edge, 19.47, 1.0) << side;
    }
}

TEST(Features, ParticlesMoveAsTheirPlacesSay) {
    // Gains that change in time are not counted, so away from ramps; the wake at a fixed place by its own frequency.
    const auto check = [](const Sea& sea, SeaTime t, LatticePoint p, double tolerance) {
        const SurfaceSample s = SeaInstant(sea, t).evaluate(p);
        const SurfaceSample before = SeaInstant(sea, t - 20'000).evaluate(p);
        const SurfaceSample after = SeaInstant(sea, t + 20'000).evaluate(p);
        EXPECT_NEAR(wide(s.vy), wide(after.ay - before.ay) / 0.04, tolerance);
        EXPECT_NEAR(wide(s.vx), -wide(after.ax - before.ax) / 0.04, tolerance);
        EXPECT_NEAR(wide(s.vz), -wide(after.az - before.az) / 0.04, tolerance);
        return std::abs(wide(s.vy));
    };
    const Sea ship({prepare(record_of(3), {})});
    const BoxInstant now = instant_of(record_of(3), {300'000'000});
    const WaveTrainBox& b = ship.boxes()[0]->record;
    double fastest = 0.0;
    for (uint64_t i = 0; i < 300; ++i) {
        const int64_t u = b.length - 150'000 - static_cast<int64_t>(splitmix64(i) % 400'000);
        const int64_t v = b.width / 2 + static_cast<int64_t>(splitmix64(~i) % 60'000) - 30'000;
        const LatticePoint p{now.origin.x + ((u * b.ux - v * b.uz) >> 30),
                             now.origin.z + ((u * b.uz + v * b.ux) >> 30)};
        fastest = std::max(fastest, check(ship, {300'000'000}, p, 0.02));
    }
    EXPECT_GT(fastest, 0.1);
    WaveTrainBox noise = record_of(5);
    noise.noise.displayed_only = false;
    const Sea rough({prepare(noise, {})});
    for (uint64_t i = 0; i < 100; ++i) check(rough, {5'000'000'000}, some_point(i, 1'000'000), 0.01);
}

TEST(Features, NothingJumpsAcrossBordersWrapsAndLegs) {
    const Sea sea = everything_sea();
    double worst = 0.0;
    const auto step = [&](SeaTime t, LatticePoint a, LatticePoint b) {
        const SurfaceSample s = SeaInstant(sea, t).evaluate(a);
        const SurfaceSample e = SeaInstant(sea, t).evaluate(b);
        worst = std::max({worst, std::abs(wide(s.ay) - wide(e.ay)), std::abs(wide(s.ax) - wide(e.ax))});
    };
    // Cells and blocks of the field; every border within the box at one time.
    for (int64_t border = -10 * 65536; border <= 10 * 65536; border += 65536)
        for (int64_t other = -500'000; other < 500'000; other += 99'991) {
            step({250'000'000}, {border - 1, other}, {border, other});
            step({250'000'000}, {other, border - 1}, {other, border});
        }
    // A unit step is a millimetre of slopes below 1.
    EXPECT_LE(worst, 1e-3);
    // Time: legs begin and end, the box comes to rest.
    double worst_in_time = 0.0;
    for (const int64_t us : {0LL, 300'000'000LL, 400'000'000LL, 900'000'000LL, -20'000'000LL, 80'000'000LL})
        for (uint64_t i = 0; i < 200; ++i) {
            const LatticePoint p = some_point(i, 2'000'000);
            const SurfaceSample before = SeaInstant(sea, {us - 1}).evaluate(p);
            const SurfaceSample after = SeaInstant(sea, {us}).evaluate(p);
            worst_in_time = std::max(worst_in_time, std::abs(wide(before.ay) - wide(after.ay)));
        }
    EXPECT_LE(worst_in_time, 1e-4);
}

TEST(Features, TheSeaIsTheSameAtAnyPlaceThatIs4194KilometresOn) {
    // All but membership reads the low 32 bits: the box moved by 2^32 units (its field too far away) makes the same waves.
    WaveTrainBox near = everything();
    for (WaveTrain& t : near.trains) t.field = {};
    const int64_t wraps[] = {int64_t{1} << 32, -(int64_t{1} << 32), int64_t{7} << 32};
    for (const int64_t wrap : wraps) {
        WaveTrainBox far = near;
        far.origin.x += wrap;
        far.origin.z -= wrap;
        for (CourseLeg& leg : far.course) {
            leg.origin.x += wrap;
            leg.origin.z -= wrap;
        }
        ASSERT_TRUE(validate(far).has_value());
        const SeaInstant here(Sea({prepare(near, {})}), {222'000'000});
        const SeaInstant there(Sea({prepare(far, {})}), {222'000'000});
        for (uint64_t i = 0; i < 300; ++i) {
            const LatticePoint p = some_point(i, 3'000'000);
            EXPECT_EQ(here.evaluate(p), there.evaluate({p.x + wrap, p.z - wrap}));
        }
    }
}

TEST(Layers, LeftOutIsTheSeaWithoutTheFeature) {
    const SeaTime t{230'000'000};
    const auto same = [&](const Sea& whole, Layers layers, const Sea& stripped) {
        const SeaInstant a(whole, t, layers);
        const SeaInstant b(stripped, t, displayed_layers);
        int wet = 0;
        for (uint64_t i = 0; i < 300; ++i) {
            const LatticePoint p = some_point(i, 3'000'000);
            EXPECT_EQ(a.evaluate(p), b.evaluate(p));
            if (a.evaluate(p) != SurfaceSample{}) ++wet;
        }
        return wet;
    };
    const auto with_land = [](WaveTrainBox box, auto edit) {
        auto field = std::make_shared<LandField>(FieldId{2}, uint8_t{16});
        for (const auto& block : hills()->blocks()) {
            auto changed = std::make_shared<LandBlock>(*block);
            edit(*changed);
            field->set(std::move(changed));
        }
        const std::shared_ptr<const LandField> fields[] = {field};
        return Sea({prepare(std::move(box), fields)});
    };
    const auto untouched = [](LandBlock&) {};
    const auto without = [&](Layer layer, auto change, auto edit) {
        WaveTrainBox box = everything();
        change(box);
        EXPECT_GT(
            same(with_land(everything(), untouched), displayed_layers.without(layer), with_land(box, edit)),
            50)
            << static_cast<int>(layer);
    };
    const auto nothing = [](WaveTrainBox&) {};
    without(
        Layer::trains, [](WaveTrainBox& b) { b.trains.clear(); }, untouched);
    without(
        Layer::irregular, [](WaveTrainBox& b) { b.irregular = {}; }, untouched);
    without(
        Layer::round, [](WaveTrainBox& b) { b.roundness = 0; }, untouched);
    without(
        Layer::noise, [](WaveTrainBox& b) { b.noise = {}; }, untouched);
    without(Layer::shelter, nothing, [](LandBlock& l) { l.gain.fill(unit_node_gain); });
    without(Layer::refraction, nothing, [](LandBlock& l) { l.shift.fill(0); });
    without(Layer::orbits, nothing, [](LandBlock& l) { l.orbit.fill(unit_node_orbit); });
    EXPECT_EQ(SeaInstant(Sea({prepare(record_of(3), {})}), t, displayed_layers.without(Layer::wakes))
                  .evaluate({0, 0}),
              SurfaceSample{});
}

TEST(Layers, DisplayedNoiseIsNotInTheAuthoritativeSea) {
    const Sea sea({prepare(record_of(5), {})});
    EXPECT_EQ(SeaInstant(sea, {5}).evaluate({77, 88}), SurfaceSample{});
    EXPECT_TRUE(SeaInstant(sea, {5}).live()[0].noise.empty());
    EXPECT_NE(SeaInstant(sea, {5}, displayed_layers).evaluate({77, 88}), SurfaceSample{});
    EXPECT_EQ(SeaInstant(sea, {5}, displayed_layers).layers(), displayed_layers);
}

TEST(Successor, TakesOverWithoutAnyoneNoticing) {
    // A wind whose land changes 200 s after it rose, then again: three boxes against one.
    WaveTrainBox wind = record_of(1);
    wind.begin = {0};
    wind.end = {2'000'000'000};
    wind.decay_us = 60'000'000;
    for (WaveTrain& t : wind.trains) t.field = {};
    const Sea whole({prepare(wind, {})});
    const int64_t fade = 10'000'000;
    const auto succeeded = [&](const WaveTrainBox& old, SeaTime at, uint32_t id) {
        WaveTrainBox next = old;
        next.id = {id};
        next.begin = at;
        next.raised_us = old.raised_us + (at - old.begin);
        next.fade_us = fade;
        return next;
    };
    const auto ended = [&](WaveTrainBox old, SeaTime at) {
        old.end = at;
        old.decay_us = fade;
        return old;
    };
    const SeaTime first{200'000'000};
    const SeaTime second{260'000'000};
    WaveTrainBox b = succeeded(wind, first, 20);
    const WaveTrainBox c = succeeded(b, second, 21);
    ASSERT_TRUE(validate(c).has_value());
    const Sea split({prepare(ended(wind, first), {}), prepare(ended(b, second), {}), prepare(c, {})});
    double worst = 0.0;
    double highest = 0.0;
    for (int64_t us = 190'000'000; us < 280'000'000; us += 333'333)
        for (uint64_t i = 0; i < 60; ++i) {
            const LatticePoint p = some_point(i, 1'500'000);
            const SurfaceSample s = SeaInstant(whole, {us}).evaluate(p);
            const SurfaceSample e = SeaInstant(split, {us}).evaluate(p);
            worst = std::max({worst, std::abs(wide(s.ay) - wide(e.ay)), std::abs(wide(s.ax) - wide(e.ax)),
                              std::abs(wide(s.yx) - wide(e.yx))});
            highest = std::max(highest, std::abs(wide(s.ay)));
        }
    EXPECT_GT(highest, 0.1);
    EXPECT_LE(worst, 1e-6);
}

TEST(WaterAt, FindsTheSurfaceWithEveryFeature) {
    const SeaInstant sea(everything_sea(), {250'000'000});
    for (uint64_t i = 0; i < 1000; ++i) {
        const LatticePoint place = some_point(i, 3'000'000);
        const WaterPoint w = water_at(sea, place);
        const SurfaceSample s = sea.evaluate(w.rest);
        EXPECT_LE(std::abs(to_metres(w.rest.x - place.x) - wide(s.ax)), 0.001);
        EXPECT_LE(std::abs(to_metres(w.rest.z - place.z) - wide(s.az)), 0.001);
    }
}

}  // namespace
}  // namespace trochoid
