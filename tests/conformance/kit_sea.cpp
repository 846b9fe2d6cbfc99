#include "tests/conformance/kit_sea.hpp"

#include <utility>

#include "protocol/units/sea_time.hpp"

namespace trochoid::conformance {

namespace {

constexpr FieldId land{7};
constexpr uint8_t land_step = 16;

/// A wave of so many metres towards east, a little to the south.
WaveTrain train_of(int32_t metres, float amplitude, FieldId field = {}) {
    WaveTrain train;
    train.kx = static_cast<int32_t>((int64_t{1} << 32) / (metres * lattice_per_metre));
    train.kz = train.kx / 5;
    // 2^64 / (0.8 s per root of a metre): near enough to deep water.
    train.omega = (uint64_t{1} << 43) / static_cast<uint64_t>(metres / 8 + 1);
    train.phase = static_cast<uint32_t>(metres) * 0x1234567U;
    train.amplitude = amplitude;
    train.choppiness = 0.75F;
    train.field = field;
    return train;
}

void add_box(InterestState& state, WaveTrainBox box) {
    const BoxId id = box.id;
    state.boxes[id] = std::make_shared<const WaveTrainBox>(std::move(box));
}

void add_block(InterestState& state, BlockKey key, int32_t slope) {
    auto block = std::make_shared<LandBlock>();
    block->key = key;
    for (int z = 0; z < block_nodes; ++z)
        for (int x = 0; x < block_nodes; ++x) {
            const auto node = static_cast<size_t>(z * block_nodes + x);
            block->shift[node] = (key.x * block_cells + x) * slope + z * 40;
            block->gain[node] = static_cast<uint16_t>(unit_node_gain - 100 * z);
            block->orbit[node] = static_cast<uint16_t>(unit_node_orbit + 30 * x);
        }
    state.blocks[{land, key}] = {land, land_step, std::move(block)};
}

}  // namespace

InterestState small_sea() {
    InterestState state;
    WaveTrainBox everywhere;
    everywhere.id = {1};
    everywhere.first_train = {1};
    everywhere.trains = {train_of(120, 0.5F), train_of(60, 0.25F), train_of(24, 0.125F)};
    add_box(state, everywhere);
    WaveTrainBox windy;
    windy.id = {2};
    windy.first_train = {10};
    windy.origin = {-(1 << 20), -(1 << 20)};
    windy.length = 1 << 21;
    windy.width = 1 << 21;
    windy.ramp_rear = windy.ramp_front = windy.ramp_side = 1 << 16;
    windy.build_up_us = 60 * microseconds_per_second;
    windy.trains = {train_of(80, 0.75F, land), train_of(40, 0.5F, land)};
    add_box(state, windy);
    add_block(state, {0, 0}, 300);
    add_block(state, {-1, 0}, 300);
    for (int32_t x = -2; x < 2; ++x)
        for (int32_t z = -2; z < 2; ++z) {
            PatchDescriptor patch;
            patch.key = {16, x, z};
            patch.boxes = {{{1}, 3}, {{2}, 2}};
            patch.left_out = 0.01F;
            patch.height_error = 0.02F;
            state.patches[patch.key] = patch;
        }
    return state;
}

InterestState grown_sea() {
    InterestState state = small_sea();
    WaveTrainBox ending = *state.boxes.at({2});
    ending.end = {kit_sea_begin.us + 300 * microseconds_per_second};
    ending.decay_us = 60 * microseconds_per_second;
    add_box(state, ending);
    add_box(state, laden_box({5}));
    add_block(state, {-1, 0}, 250);
    add_block(state, {0, -1}, 300);
    state.patches.erase({16, -2, -2});
    PatchDescriptor wide;
    wide.key = {17, 1, 1};
    wide.boxes = {{{1}, 2}, {{2}, 1}, {{5}, 1}};
    state.patches[wide.key] = wide;
    state.patches.at({16, 0, 0}).boxes = {{{1}, 2}, {{5}, 1}};
    return state;
}

WaveTrainBox laden_box(BoxId id) {
    WaveTrainBox box;
    box.id = id;
    box.first_train = {20};
    box.origin = {-4096000, -4096000};
    box.length = 8192000;
    box.width = 2048000;
    box.ramp_rear = box.ramp_front = box.ramp_side = 1 << 14;
    box.begin = {kit_sea_begin.us - 900 * microseconds_per_second};
    box.raised_us = 5 * microseconds_per_second;
    box.fade_us = 10 * microseconds_per_second;
    box.roundness = 1 << 12;
    box.trains = {train_of(50, 0.25F, land)};
    box.overlays = {{land, {3}}};
    box.course = {{box.begin, int64_t{7200} * microseconds_per_second, box.origin, 17180, -8590}};
    box.irregular.share = 1 << 13;
    box.irregular.ukx = 700;
    box.irregular.ukz = 10;
    box.irregular.vkx = -10;
    box.irregular.vkz = 700;
    box.irregular.omega = uint64_t{1} << 38;
    box.noise.amplitude = 0.0625F;
    box.noise.octaves = 3;
    box.noise.persistence = 1 << 14;
    box.noise.seed = 99;
    box.wake.transverse = 0.125F;
    box.wake.diverging = 0.125F;
    box.wake.choppiness = 0.5F;
    box.wake.inverse_length = 1 << 24;
    box.wake.group_speed = 60000;
    box.hull = {120.0F, 17.0F};
    return box;
}

InterestState laden_sea() {
    InterestState state = small_sea();
    add_box(state, laden_box({5}));
    return state;
}

}  // namespace trochoid::conformance
