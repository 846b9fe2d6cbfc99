#include "protocol/model/self_check.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {

namespace {

/// A train from integers alone: k by a rational direction, omega by an integer of the right size.
WaveTrain reference_train(uint64_t seed, int32_t kx, int32_t kz, uint64_t omega, float amplitude,
                          float choppiness, uint32_t field) {
    WaveTrain t;
    t.kx = kx;
    t.kz = kz;
    t.omega = omega;
    t.phase = static_cast<uint32_t>(splitmix64(seed));
    t.amplitude = amplitude;
    t.choppiness = choppiness;
    t.field = {field};
    return t;
}

std::shared_ptr<const LandField> reference_field() {
    auto field = std::make_shared<LandField>(FieldId{1}, uint8_t{16});
    for (int32_t bz = -2; bz < 2; ++bz)
        for (int32_t bx = -2; bx < 2; ++bx) {
            auto block = std::make_shared<LandBlock>();
            block->key = {bx, bz};
            for (int z = 0; z < block_nodes; ++z)
                for (int x = 0; x < block_nodes; ++x) {
                    // Integer hills of the node's global index: common edges agree by construction.
                    const int64_t nx = int64_t{bx} * block_cells + x;
                    const int64_t nz = int64_t{bz} * block_cells + z;
                    const auto i = static_cast<size_t>(z * block_nodes + x);
                    block->shift[i] = static_cast<int32_t>((nx * nx - nz * nz) * 211 + nx * 1777);
                    block->gain[i] = static_cast<uint16_t>(((nx * nx + 3 * nz * nz) * 37) & 0xbfff);
                }
            field->set(std::move(block));
        }
    return field;
}

/// Bed with shift, gain and orbits all at work: nodes of 32 m.
std::shared_ptr<LandField> reference_shoal(uint32_t id, int32_t first, int32_t last, int64_t salt) {
    auto field = std::make_shared<LandField>(FieldId{id}, uint8_t{15});
    for (int32_t bz = first; bz <= last; ++bz)
        for (int32_t bx = first; bx <= last; ++bx) {
            auto block = std::make_shared<LandBlock>();
            block->key = {bx, bz};
            for (int z = 0; z < block_nodes; ++z)
                for (int x = 0; x < block_nodes; ++x) {
                    const int64_t nx = int64_t{bx} * block_cells + x;
                    const int64_t nz = int64_t{bz} * block_cells + z;
                    const auto i = static_cast<size_t>(z * block_nodes + x);
                    block->shift[i] = static_cast<int32_t>((nx * nx + nz * nz) * (31 + salt) - nz * 577);
                    block->gain[i] =
                        static_cast<uint16_t>(20'000 + ((nx * nx + nz * nz) * 5 + salt * 999) % 9'000);
                    block->orbit[i] = static_cast<uint16_t>(16'384 + ((nx * 3 - nz) * (nx + nz) & 0x3fff));
                }
            field->set(std::move(block));
        }
    return field;
}

/// A storm that moves over a shoal; two of the shoal's blocks have changed since (field 3 over field 2).
WaveTrainBox reference_storm() {
    WaveTrainBox storm;
    storm.id = {3};
    storm.first_train = {6};
    storm.origin = {-1'300'000, 400'000};
    storm.ux = 644'245'094;  // 0.6, -0.8
    storm.uz = -858'993'459;
    storm.length = 1'900'000;
    storm.width = 1'700'000;
    storm.ramp_rear = 300'000;
    storm.ramp_front = 300'000;
    storm.ramp_side = 250'000;
    storm.begin = {-20'000'000};
    storm.build_up_us = 100'000'000;
    storm.gain_max = 58'000;
    storm.roundness = 24'576;
    storm.trains = {reference_train(6, 48013, -62011, 1702102102102ULL, 0.5F, 0.75F, 3),
                    reference_train(7, 100003, -130011, 2402902902902ULL, 0.1875F, 0.5F, 2),
                    reference_train(8, 61001, -230017, 2965605605605ULL, 0.125F, 1.0F, 0)};
    storm.overlays = {{FieldId{3}, FieldId{2}}};
    // East at 5 m/s, then south-west at 7; then it lies where it came to.
    storm.course = {{{0}, 300'000'000, storm.origin, 85'900, 0},
                    {{400'000'000}, 500'000'000, {236'011, 400'000}, -80'007, 90'001}};
    storm.irregular = {20'000, 8'003, -10'007, 10'007, 8'003, 141'700'000'000ULL, 77'777'777, 3'333'333'333U};
    storm.noise = {0.0625F, 40'000, 3, 11, 21, false, 2004};
    return storm;
}

/// A ship at 6 m/s that stops after ten minutes.
WaveTrainBox reference_ship() {
    WaveTrainBox ship;
    ship.id = {4};
    ship.first_train = {9};
    ship.ux = -858'993'459;  // -0.8, 0.6
    ship.uz = 644'245'094;
    ship.origin = {2'900'000, -2'600'000};
    ship.length = 2'500'000;
    ship.width = 1'900'000;
    ship.ramp_rear = 100'000;
    ship.begin = {-300'000'000};
    ship.build_up_us = 20'000'000;
    ship.end = {600'000'000};
    ship.decay_us = 250'000'000;
    ship.course = {{ship.begin, 1'200'000'000, ship.origin, -82'464, 61'848}};
    ship.wake = {0.25F, 0.375F, 0.75F, 46'549'000, 51'540};
    return ship;
}

/// What takes over from a wind at 200 s, within 60 s, when the land has changed.
WaveTrainBox reference_successor() {
    WaveTrainBox next;
    next.id = {5};
    next.first_train = {10};
    next.origin = {-1'200'000, -300'000};
    next.length = 3'000'000;
    next.width = 2'000'000;
    next.begin = {200'000'000};
    next.raised_us = 150'000'000;
    next.fade_us = 60'000'000;
    next.build_up_us = 500'000'000;
    next.front_speed = 110'000;
    next.end = {5'000'000'000};
    next.decay_us = 60'000'000;
    next.trains = {reference_train(10, 90'001, 12'007, 2054321054321ULL, 0.375F, 1.0F, 0)};
    return next;
}

WaveTrainBox reference_noise() {
    WaveTrainBox everywhere;
    everywhere.id = {6};
    everywhere.first_train = {11};
    everywhere.noise = {0.03125F, 32'768, 4, 10, 20, true, 77};
    return everywhere;
}

}  // namespace

Sea reference_sea() {
    WaveTrainBox swell;
    swell.id = {1};
    swell.first_train = {1};
    swell.trains = {reference_train(1, 40018, 8021, 1613943558211ULL, 1.25F, 0.8F, 0),
                    reference_train(2, -61007, 120013, 2943558211613ULL, 0.5F, 0.9F, 0)};
    WaveTrainBox wind;
    wind.id = {2};
    wind.first_train = {3};
    wind.origin = {-900'000, -700'000};
    wind.ux = 858'993'459;  // 0.8, 0.6 in Q2.30
    wind.uz = 644'245'094;
    wind.length = 2'400'000;
    wind.width = 1'300'000;
    wind.ramp_rear = 120'000;
    wind.ramp_front = 200'000;
    wind.ramp_side = 150'000;
    wind.begin = {3'000'000};
    wind.build_up_us = 600'000'000;
    wind.end = {315'360'000'000'000};  // ten years
    wind.decay_us = 900'000'000;
    wind.front_speed = 120'000;
    wind.gain_max = 0xbfff;
    const uint32_t field = 1;
    wind.trains = {reference_train(3, 70001, 52501, 2102102102102ULL, 0.75F, 1.0F, field),
                   reference_train(4, 141007, 90007, 2902902902902ULL, 0.25F, 0.7F, field),
                   reference_train(5, 500009, -300007, 5605605605605ULL, 0.03125F, 0.5F, 0)};
    const std::shared_ptr<const LandField> fields[] = {reference_field(), reference_shoal(2, -1, 0, 0),
                                                       reference_shoal(3, 0, 0, 3)};
    return Sea({prepare(swell, {}), prepare(wind, fields), prepare(reference_storm(), fields),
                prepare(reference_ship(), {}), prepare(reference_successor(), {}),
                prepare(reference_noise(), {})});
}

}  // namespace trochoid
