#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "protocol/model/point_query.hpp"
#include "protocol/model/self_check.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

/// Numbers from a seed, with the ends of their range more often than chance gives.
class Dice {
public:
    explicit Dice(uint64_t seed) : state_(seed) {}
    uint64_t bits() { return state_ = splitmix64(state_); }
    int64_t between(int64_t low, int64_t high) {
        const uint64_t h = bits();
        if (h % 16 == 0) return low;
        if (h % 16 == 1) return high;
        return low + static_cast<int64_t>(bits() % (static_cast<uint64_t>(high - low) + 1));
    }
    template <class T>
    T in(int64_t low, int64_t high) {
        return static_cast<T>(between(low, high));
    }
    bool one_in(uint64_t n) { return bits() % n == 0; }
    float amplitude() {
        if (one_in(8)) return 32.0F;
        return std::ldexp(1.0F, in<int>(-20, 4));
    }

private:
    uint64_t state_;
};

WaveTrain random_train(Dice& d) {
    WaveTrain t;
    t.kx = d.in<int32_t>(-INT32_MAX, INT32_MAX) >> d.in<int>(0, 31);
    t.kz = d.in<int32_t>(-INT32_MAX, INT32_MAX) >> d.in<int>(0, 31);
    if (t.kx == 0 && t.kz == 0) t.kx = 1;
    t.omega = d.bits() >> d.in<int>(0, 63);
    t.phase = static_cast<uint32_t>(d.bits());
    t.amplitude = d.one_in(6) ? 0.0F : d.amplitude();
    t.choppiness = static_cast<float>(d.between(0, 64)) / 16.0F;
    t.field = {d.in<uint32_t>(0, 3)};
    return t;
}

WaveTrainBox random_box(Dice& d, uint32_t id) {
    static constexpr int32_t directions[][2] = {
        {1 << 30, 0}, {0, -(1 << 30)}, {644'245'094, -858'993'459}, {-858'993'459, -644'245'094}};
    WaveTrainBox b;
    b.id = {id};
    b.first_train = {id * 1000};
    b.origin = {d.between(-world_bound, world_bound), d.between(-world_bound, world_bound)};
    if (!d.one_in(3)) b.origin = {d.between(-2'000'000, 2'000'000), d.between(-2'000'000, 2'000'000)};
    const auto& u = directions[d.bits() % 4];
    b.ux = u[0];
    b.uz = u[1];
    b.length = d.one_in(4) ? 0 : d.between(1, d.one_in(3) ? longest_side : 4'000'000);
    b.width = d.one_in(4) ? 0 : d.between(1, d.one_in(3) ? longest_side : 4'000'000);
    b.ramp_rear = d.in<int32_t>(shortest_ramp, 2'000'000);
    b.ramp_front = d.in<int32_t>(shortest_ramp, longest_side);
    b.ramp_side = d.in<int32_t>(shortest_ramp, 100'000);
    b.begin = {d.between(-1'000'000'000, 1'000'000'000)};
    b.raised_us = d.one_in(3) ? d.between(0, sea_time_bound) : 0;
    b.fade_us = d.one_in(3) ? d.between(0, int64_t{1} << 39) : 0;
    b.build_up_us = d.between(0, 500'000'000);
    b.end = d.one_in(2) ? end_of_time : b.begin + d.between(0, 1'000'000'000);
    b.decay_us = d.between(0, int64_t{1} << 39);
    b.front_speed = d.one_in(2) ? 0 : d.in<uint32_t>(1, UINT32_MAX);
    b.gain_max = UINT16_MAX;
    for (int64_t n = d.between(0, 6); n > 0; --n) b.trains.push_back(random_train(d));
    if (b.width >= shortest_ramp && d.one_in(2)) {
        b.roundness = d.in<uint16_t>(0, full_roundness);
        for (WaveTrain& t : b.trains) {
            t.kx = t.kx / 128 | 1;
            t.kz /= 128;
        }
    }
    if (d.one_in(2)) {
        const WaveTrain a = random_train(d);
        const WaveTrain c = random_train(d);
        b.irregular = {
            d.in<uint16_t>(0, full_irregularity), a.kx, a.kz, c.kx, c.kz, a.omega, a.phase, c.phase};
    }
    if (d.one_in(2) || b.trains.empty()) {
        const auto octaves = d.in<uint8_t>(1, 12);
        b.noise = {d.amplitude(),
                   d.in<uint16_t>(0, UINT16_MAX),
                   octaves,
                   d.in<uint8_t>(std::max(6, 3 + octaves), 20),
                   d.in<uint8_t>(std::max(14, 11 + octaves), 40),
                   d.one_in(2),
                   static_cast<uint32_t>(d.bits())};
    }
    if (d.one_in(2))
        b.course = {{b.begin + d.between(-1000, 1000), d.between(0, 1'000'000'000), b.origin,
                     d.in<int32_t>(-fastest_leg + 1, fastest_leg - 1),
                     d.in<int32_t>(-fastest_leg + 1, fastest_leg - 1)}};
    if (b.course.size() == 1 && b.length != 0 && b.width != 0)
        b.wake = {d.amplitude(), d.amplitude(), static_cast<float>(d.between(0, 64)) / 16.0F,
                  d.in<uint32_t>(1 << 20, int64_t{1} << 31), d.in<uint32_t>(1, fastest_leg)};
    return b;
}

std::shared_ptr<const LandField> random_field(Dice& d, uint32_t id, uint8_t step) {
    auto field = std::make_shared<LandField>(FieldId{id}, step);
    for (int n = 0; n < 6; ++n) {
        auto block = std::make_shared<LandBlock>();
        block->key = {d.in<int32_t>(-8, 8), d.in<int32_t>(-8, 8)};
        for (size_t i = 0; i < block->shift.size(); ++i) {
            block->shift[i] = d.in<int32_t>(-(1 << 22) + 1, (1 << 22) - 1);
            block->gain[i] = d.in<uint16_t>(0, UINT16_MAX);
            block->orbit[i] = d.in<uint16_t>(0, UINT16_MAX);
        }
        EXPECT_TRUE(validate(*block).has_value());
        field->set(std::move(block));
    }
    return field;
}

bool finite(const SurfaceSample& s) {
    for (const float v :
         {s.ax, s.ay, s.az, s.pxx, s.pxz, s.pzx, s.pzz, s.yx, s.yz, s.nx, s.ny, s.nz, s.vx, s.vy, s.vz})
        if (!std::isfinite(v)) return false;
    return true;
}

TEST(Fuzz, AnyValidSeaIsFiniteAndWithinItsBounds) {
    int valid = 0;
    int wet = 0;
    for (uint64_t round = 0; round < 2000; ++round) {
        Dice d(round);
        const std::shared_ptr<const LandField> fields[] = {random_field(d, 1, 16), random_field(d, 2, 16),
                                                           random_field(d, 3, 12)};
        WaveTrainBox box = random_box(d, 1 + static_cast<uint32_t>(round));
        if (!validate(box)) continue;
        ++valid;
        const Sea sea({prepare(box, fields)});
        const LatticeRect bounds = bounds_of(box);
        for (int i = 0; i < 30; ++i) {
            const SeaTime t{i % 5 == 0 ? d.between(-sea_time_bound, sea_time_bound)
                                       : box.begin.us + d.between(-1000, 600'000'000)};
            const LatticePoint corner = instant_of(box, t).origin;
            // Inside the box mostly, else anywhere.
            const int64_t u = d.between(0, box.length == 0 ? 1'000'000 : box.length);
            const int64_t v = d.between(0, box.width == 0 ? 1'000'000 : box.width);
            LatticePoint p{corner.x + ((u * box.ux - v * box.uz) >> 30),
                           corner.z + ((u * box.uz + v * box.ux) >> 30)};
            if (i % 4 == 0 || !inside_world(p))
                p = {d.between(-world_bound, world_bound), d.between(-world_bound, world_bound)};
            const SurfaceSample s = SeaInstant(sea, t, displayed_layers).evaluate(p);
            ASSERT_TRUE(finite(s)) << "round " << round << " t " << t.us << " x " << p.x << " z " << p.z;
            ASSERT_LE(std::abs(static_cast<double>(s.ay)), height_bound(box)) << "round " << round;
            if (s == SurfaceSample{}) continue;
            ++wet;
            ASSERT_TRUE(contains(bounds, p)) << "round " << round;
            ASSERT_TRUE(contains(bounds_over(box, t, t), p)) << "round " << round;
        }
    }
    EXPECT_GT(valid, 1300);
    EXPECT_GT(wet, 10'000);
}

TEST(Fuzz, AQueryNeverLeavesReason) {
    // Folded seas beyond any steepness limit: the query must end, finite, near where it began.
    for (uint64_t round = 0; round < 300; ++round) {
        Dice d(round + 9'000);
        WaveTrainBox box = random_box(d, 7);
        box.length = box.width = 0;
        box.roundness = 0;
        box.wake = {};
        box.build_up_us = box.fade_us = 0;
        if (!validate(box)) continue;
        const SeaInstant sea(Sea({prepare(box, {})}), box.begin + 5);
        const LatticePoint p{d.between(-1'000'000, 1'000'000), d.between(-1'000'000, 1'000'000)};
        const WaterPoint w = water_at(sea, p);
        ASSERT_TRUE(std::isfinite(w.height)) << round;
        ASSERT_LE(std::abs(w.rest.x - p.x), 4 * 65'536) << round;
    }
}

}  // namespace
}  // namespace trochoid
