#include <gtest/gtest.h>

#include <bit>
#include <functional>
#include <set>

#include "protocol/model/interest_state.hpp"
#include "tests/unit/codec/random_messages.hpp"

// The hashes that both ends compare, against the standard's words (chapter 8) written down a second time.
namespace trochoid {
namespace {

/// Bytes in the order in which the standard names the values.
struct Line {
    std::vector<uint8_t> bytes;
    template <class T>
    Line& operator<<(T value) {
        uint64_t bits = 0;
        if constexpr (std::is_same_v<T, float>)
            bits = std::bit_cast<uint32_t>(value);
        else
            bits = static_cast<uint64_t>(value);
        for (size_t i = 0; i < sizeof(T); ++i) bytes.push_back(static_cast<uint8_t>(bits >> (8 * i)));
        return *this;
    }
    uint64_t fnv() const {
        uint64_t h = 14695981039346656037ULL;
        for (const uint8_t b : bytes) h = (h ^ b) * 1099511628211ULL;
        return h;
    }
};

uint64_t hash_by_the_book(const WaveTrainBox& b) {
    Line l;
    l << b.id.value << b.first_train.value << b.origin.x << b.origin.z << b.ux << b.uz << b.length << b.width;
    l << b.ramp_rear << b.ramp_front << b.ramp_side << b.begin.us << b.build_up_us << b.end.us << b.decay_us;
    l << b.front_speed << b.gain_max << b.raised_us << b.fade_us << b.roundness;
    l << static_cast<uint32_t>(b.trains.size());
    for (const WaveTrain& t : b.trains)
        l << t.kx << t.kz << t.omega << t.phase << t.amplitude << t.choppiness << t.field.value;
    l << static_cast<uint32_t>(b.overlays.size());
    for (const FieldOverlay& o : b.overlays) l << o.field.value << o.base.value;
    l << static_cast<uint32_t>(b.course.size());
    for (const CourseLeg& c : b.course)
        l << c.from.us << c.duration_us << c.origin.x << c.origin.z << c.vx << c.vz;
    const IrregularHeight& i = b.irregular;
    l << i.share << i.ukx << i.ukz << i.vkx << i.vkz << i.omega << i.phase_u << i.phase_v;
    const SurfaceNoise& n = b.noise;
    l << n.amplitude << n.persistence << n.octaves << n.step_log2 << n.period_log2;
    l << static_cast<uint8_t>(n.displayed_only) << n.seed;
    const ShipWake& w = b.wake;
    l << w.transverse << w.diverging << w.choppiness << w.inverse_length << w.group_speed;
    return l.fnv();
}

TEST(StateHash, OfBoxesIsTheStandards) {
    Dice dice(61);
    for (int i = 0; i < 200; ++i) {
        const WaveTrainBox box = i % 4 == 0 ? random_ship(dice, 9) : random_box(dice, 9, 3);
        ASSERT_EQ(hash_of(box), hash_by_the_book(box));
    }
    EXPECT_EQ(hash_of(WaveTrainBox{}), hash_by_the_book({}));
}

TEST(StateHash, OfBlocksIsTheStandards) {
    Dice dice(62);
    for (int i = 0; i < 20; ++i) {
        const LandBlock block = random_block(dice, {-3, 4 + i});
        Line l;
        l << block.key.x << block.key.z;
        for (const int32_t s : block.shift) l << s;
        for (const uint16_t g : block.gain) l << g;
        for (const uint16_t o : block.orbit) l << o;
        ASSERT_EQ(hash_of(block), l.fnv());
    }
}

/// So that programs that know no hulls, and drop them, agree.
TEST(StateHash, AHullDoesNotCount) {
    Dice dice(64);
    WaveTrainBox ship = random_ship(dice, 9);
    const uint64_t bare = hash_of(ship);
    ship.hull = {120.0F, 18.0F};
    EXPECT_EQ(hash_of(ship), bare);
}

TEST(StateHash, EveryFieldOfABoxCounts) {
    Dice dice(63);
    WaveTrainBox full = random_box(dice, 9, 2);
    full.overlays = {{{2}, {1}}};
    full.course = {{{1}, 2, {3, 4}, 5, 6}};
    using B = WaveTrainBox;
    const std::vector<std::function<void(B&)>> changes{
        [](B& b) { b.raised_us ^= 1; },
        [](B& b) { b.fade_us ^= 1; },
        [](B& b) { b.roundness ^= 1; },
        [](B& b) { b.overlays[0].field.value ^= 1; },
        [](B& b) { b.overlays[0].base.value ^= 4; },
        [](B& b) { b.overlays.clear(); },
        [](B& b) { b.course[0].from.us ^= 1; },
        [](B& b) { b.course[0].duration_us ^= 1; },
        [](B& b) { b.course[0].origin.x ^= 1; },
        [](B& b) { b.course[0].origin.z ^= 1; },
        [](B& b) { b.course[0].vx ^= 1; },
        [](B& b) { b.course[0].vz ^= 1; },
        [](B& b) { b.course.clear(); },
        [](B& b) { b.irregular.share ^= 1; },
        [](B& b) { b.irregular.ukx ^= 1; },
        [](B& b) { b.irregular.ukz ^= 1; },
        [](B& b) { b.irregular.vkx ^= 1; },
        [](B& b) { b.irregular.vkz ^= 1; },
        [](B& b) { b.irregular.omega ^= 1; },
        [](B& b) { b.irregular.phase_u ^= 1; },
        [](B& b) { b.irregular.phase_v ^= 1; },
        [](B& b) { b.noise.amplitude += 1.0F; },
        [](B& b) { b.noise.persistence ^= 1; },
        [](B& b) { b.noise.octaves ^= 1; },
        [](B& b) { b.noise.step_log2 ^= 1; },
        [](B& b) { b.noise.period_log2 ^= 1; },
        [](B& b) { b.noise.displayed_only = !b.noise.displayed_only; },
        [](B& b) { b.noise.seed ^= 1; },
        [](B& b) { b.wake.transverse += 1.0F; },
        [](B& b) { b.wake.diverging += 1.0F; },
        [](B& b) { b.wake.choppiness += 1.0F; },
        [](B& b) { b.wake.inverse_length ^= 1; },
        [](B& b) { b.wake.group_speed ^= 1; }};
    std::set<uint64_t> hashes{hash_of(full)};
    for (const auto& change : changes) {
        B other = full;
        change(other);
        EXPECT_TRUE(hashes.insert(hash_of(other)).second) << "change " << hashes.size();
    }
}

}  // namespace
}  // namespace trochoid
