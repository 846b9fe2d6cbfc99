#include "protocol/model/self_check.hpp"

#include <fmt/format.h>

#include "protocol/units/hash.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

constexpr uint64_t self_check_seed = 2004;
constexpr uint32_t self_check_points = 512;
constexpr uint64_t self_check_hash = 0xe789e676af1f166f;

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
    const std::shared_ptr<const LandField> fields[] = {reference_field()};
    return Sea({prepare(swell, {}), prepare(wind, fields)});
}

uint64_t reference_hash(uint64_t seed, uint32_t count) {
    const Sea sea = reference_sea();
    std::vector<SurfaceSample> samples;
    samples.reserve(count);
    constexpr uint32_t points_per_time = 64;
    for (uint32_t i = 0; i < count;) {
        // Times over twelve years, so begin, plateau, decay and the calm after are all met.
        const uint64_t h = splitmix64(seed ^ (uint64_t{i} << 32));
        const int64_t spread = (i / points_per_time) % 2 == 0 ? 900'000'000 : 378'432'000'000'000;
        const SeaInstant instant(sea, SeaTime{static_cast<int64_t>(h % static_cast<uint64_t>(spread))});
        for (uint32_t j = 0; j < points_per_time && i < count; ++j, ++i) {
            const uint64_t a = splitmix64(h + j);
            const uint64_t b = splitmix64(a);
            // Near the fields mostly, every eighth anywhere within 10,000 km.
            const uint64_t span = j % 8 == 7 ? 20'480'000'000ULL : 4'194'304ULL;
            samples.push_back(
                instant.evaluate({static_cast<int64_t>(a % span) - static_cast<int64_t>(span / 2),
                                  static_cast<int64_t>(b % span) - static_cast<int64_t>(span / 2)}));
        }
    }
    return hash_of(samples);
}

void self_check() {
    const uint64_t hash = reference_hash(self_check_seed, self_check_points);
    if (hash != self_check_hash)
        throw OperatorError(fmt::format(
            "this build computes another sea (self-check {:016x}, expected {:016x}): rebuild with -ffp-contract=off and "
            "without -ffast-math",
            hash, self_check_hash));
}

}  // namespace trochoid
