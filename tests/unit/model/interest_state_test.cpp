#include "protocol/model/interest_state.hpp"

#include <gtest/gtest.h>

#include <random>

#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

class RandomState {
public:
    explicit RandomState(uint32_t seed) : engine_(seed) {}

    /// A state of small numbers, so that two states share keys and sometimes values.
    InterestState next() {
        InterestState state;
        for (uint32_t id = 1; id <= 6; ++id)
            if (one_in(2)) state.boxes[{id}] = box(id);
        for (uint32_t field = 1; field <= 2; ++field)
            for (int32_t x = -1; x <= 1; ++x)
                if (one_in(2)) {
                    const FieldBlock b = block(field, x);
                    state.blocks[{b.field, b.block->key}] = b;
                }
        for (int32_t x = -4; x <= 4; ++x)
            if (one_in(2)) {
                const PatchDescriptor p = patch(x);
                state.patches[p.key] = p;
            }
        return state;
    }

private:
    bool one_in(uint32_t n) { return engine_() % n == 0; }
    std::shared_ptr<const WaveTrainBox> box(uint32_t id) {
        auto b = std::make_shared<WaveTrainBox>();
        b->id = {id};
        b->trains.resize(1 + engine_() % 2);
        b->trains[0].kx = static_cast<int32_t>(engine_() % 3);
        return b;
    }
    FieldBlock block(uint32_t field, int32_t x) {
        auto b = std::make_shared<LandBlock>();
        b->key = {x, -x};
        b->shift[7] = static_cast<int32_t>(engine_() % 2);
        FieldBlock out{{field}, 16, b};
        if (one_in(2)) out.content = hash_of(*b);
        return out;
    }
    PatchDescriptor patch(int32_t x) {
        PatchDescriptor p;
        p.key = {static_cast<uint8_t>(15 + engine_() % 2), x, -3};
        p.boxes.resize(engine_() % 3, PatchBox{{1}, 4});
        p.left_out = static_cast<float>(engine_() % 2);
        return p;
    }
    std::mt19937 engine_;
};

TEST(InterestState, DifferenceAppliedToItsBaseGivesTheTarget) {
    RandomState random(1);
    int empty = 0;
    for (int i = 0; i < 2000; ++i) {
        InterestState base = random.next();
        const InterestState target = i % 10 == 0 ? base : random.next();
        const InterestDelta delta = difference(base, target);
        EXPECT_EQ(delta.empty(), hash_of(base) == hash_of(target));
        empty += delta.empty() ? 1 : 0;
        apply(base, delta);
        ASSERT_EQ(hash_of(base), hash_of(target));
        ASSERT_TRUE(difference(base, target).empty());
        ASSERT_TRUE(difference(target, base).empty());
    }
    EXPECT_EQ(empty, 200);
}

TEST(InterestState, SnapshotIsTheDifferenceFromNothing) {
    const InterestState target = RandomState(2).next();
    InterestState client;
    apply(client, difference({}, target));
    EXPECT_EQ(hash_of(client), hash_of(target));
    apply(client, difference(target, {}));
    EXPECT_EQ(hash_of(client), hash_of(InterestState{}));
}

TEST(InterestState, DeltaHoldsOnlyWhatChanged) {
    RandomState random(3);
    InterestState base;
    while (base.patches.size() < 3 || base.boxes.size() < 2) base = random.next();
    InterestState target = base;
    const PatchKey gone = target.patches.begin()->first;
    target.patches.erase(gone);
    target.patches.rbegin()->second.left_out += 1.0F;
    // An equal record in another place in memory is no change.
    target.boxes.begin()->second = std::make_shared<WaveTrainBox>(*target.boxes.begin()->second);
    const InterestDelta delta = difference(base, target);
    EXPECT_EQ(delta.removed_patches, std::vector<PatchKey>{gone});
    EXPECT_EQ(delta.patches.size(), 1U);
    EXPECT_TRUE(delta.boxes.empty());
    EXPECT_TRUE(delta.blocks.empty());
}

TEST(InterestState, EveryFieldEntersTheHash) {
    WaveTrainBox box;
    box.trains.resize(1);
    const uint64_t before = hash_of(box);
    const auto differs = [&](auto change) {
        WaveTrainBox other = box;
        change(other);
        return hash_of(other) != before;
    };
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.id = {1}; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.first_train = {1}; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.origin.z = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.uz = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.length = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.width = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.ramp_front += 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.begin.us = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.build_up_us = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.end.us = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.decay_us = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.front_speed = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.gain_max = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.trains[0].omega = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.raised_us = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.fade_us = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.roundness = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.overlays.push_back({{2}, {1}}); }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.course.push_back({}); }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.irregular.share = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.irregular.ukx = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.irregular.ukz = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.irregular.vkx = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.irregular.vkz = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.irregular.omega = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.irregular.phase_u = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.irregular.phase_v = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.noise.amplitude = 1.0F; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.noise.persistence = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.noise.octaves = 2; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.noise.step_log2 = 10; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.noise.period_log2 = 20; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.noise.displayed_only = false; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.noise.seed = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.wake.transverse = 1.0F; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.wake.diverging = 1.0F; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.wake.choppiness = 1.0F; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.wake.inverse_length = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.wake.group_speed = 1; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.trains[0].choppiness = 1.0F; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.trains[0].field = {1}; }));
    EXPECT_TRUE(differs([](WaveTrainBox& b) { b.trains.push_back({}); }));
}

TEST(InterestState, CullKeysHashByTheirValues) {
    CullKey key;
    const uint64_t before = hash_of(key);
    EXPECT_EQ(hash_of(CullKey{}), before);
    key.anchor.qx = 0.5F;
    EXPECT_NE(hash_of(key), before);
    key = {};
    key.regions.push_back({{1, 2}, 3});
    EXPECT_NE(hash_of(key), before);
    key = {};
    key.until = {5};
    EXPECT_NE(hash_of(key), before);
}

TEST(InterestState, HashIsWrittenLittleEndianFieldByField) {
    // The twin: a block's bytes laid out by hand, then FNV-1a.
    LandBlock block;
    block.key = {-2, 3};
    block.shift[0] = -5;
    block.gain[288] = 0x1234;
    std::vector<uint8_t> bytes;
    const auto put = [&](uint64_t v, int n) {
        for (int i = 0; i < n; ++i) bytes.push_back(static_cast<uint8_t>(v >> (8 * i)));
    };
    put(static_cast<uint32_t>(-2), 4);
    put(3, 4);
    put(static_cast<uint32_t>(-5), 4);
    for (int i = 1; i < 289; ++i) put(0, 4);
    for (int i = 0; i < 288; ++i) put(0, 2);
    put(0x1234, 2);
    block.orbit[1] = 0x4321;
    put(unit_node_orbit, 2);
    put(0x4321, 2);
    for (int i = 2; i < 289; ++i) put(unit_node_orbit, 2);
    EXPECT_EQ(hash_of(block), Hash64().bytes(bytes).value());
}

TEST(PatchKey, RectsTileThePlane) {
    EXPECT_EQ(rect_of({16, 0, 0}), (LatticeRect{{0, 0}, {65536, 65536}}));
    EXPECT_EQ(rect_of({15, -1, 2}), (LatticeRect{{-32768, 65536}, {0, 98304}}));
    EXPECT_EQ(patch_at({-1, 65536}, 15), (PatchKey{15, -1, 2}));
    EXPECT_EQ(patch_at({world_bound - 1, -world_bound}, 26), (PatchKey{26, 511, -512}));
    EXPECT_EQ(rect_of({26, 511, -512}).max.x, world_bound);
}

}  // namespace
}  // namespace trochoid
