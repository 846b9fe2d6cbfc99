#include "tests/unit/simd/random_sea.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace trochoid {

namespace {

class Dice {
public:
    explicit Dice(uint64_t seed) : engine_(seed) {}
    int64_t whole(int64_t low, int64_t high) {
        return std::uniform_int_distribution<int64_t>(low, high)(engine_);
    }
    double real(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine_);
    }
    bool one_in(int n) { return whole(1, n) == 1; }

private:
    std::mt19937_64 engine_;
};

constexpr double turn = 6.283185307179586;

WaveTrain random_train(Dice& dice, double heading) {
    WaveTrain t;
    const double wavelength = std::exp(dice.real(std::log(0.5), std::log(600.0)));
    const double turns = 4294967296.0 / (wavelength * 1024.0);
    const double direction = heading + dice.real(-1.0, 1.0);
    t.kx = static_cast<int32_t>(turns * std::cos(direction));
    t.kz = static_cast<int32_t>(turns * std::sin(direction)) | 1;
    t.omega = static_cast<uint64_t>(dice.whole(1'000'000'000'000, 20'000'000'000'000));
    t.phase = static_cast<uint32_t>(dice.whole(0, UINT32_MAX));
    t.amplitude = static_cast<float>(std::max(0x1p-20, wavelength * dice.real(0.001, 0.01)));
    t.choppiness = static_cast<float>(dice.real(0.0, 1.2));
    return t;
}

std::shared_ptr<const LandField> random_field(Dice& dice, uint32_t id, const RandomSeaOptions& options,
                                              uint8_t step, const std::shared_ptr<const LandField>& base) {
    auto field = std::make_shared<LandField>(FieldId{id}, step);
    const LatticePoint c = options.centre;
    const int64_t reach = options.extent;
    const BlockRange range = blocks_touching({{c.x - reach, c.z - reach}, {c.x + reach, c.z + reach}}, step);
    const auto middle_x = (int64_t{range.first.x} + range.last.x) / 2;
    const auto middle_z = (int64_t{range.first.z} + range.last.z) / 2;
    for (int64_t bz = std::max<int64_t>(range.first.z, middle_z - 3);
         bz <= std::min<int64_t>(range.last.z, middle_z + 3); ++bz)
        for (int64_t bx = std::max<int64_t>(range.first.x, middle_x - 3);
             bx <= std::min<int64_t>(range.last.x, middle_x + 3); ++bx) {
            if (dice.one_in(4) || (base && dice.one_in(2))) continue;  // holes
            auto block = std::make_shared<LandBlock>();
            block->key = {static_cast<int32_t>(bx), static_cast<int32_t>(bz)};
            const int64_t rough = dice.one_in(3) ? 4'000'000 : 60'000;
            const bool even = dice.one_in(3);
            for (size_t i = 0; i < block->shift.size(); ++i) {
                block->shift[i] = static_cast<int32_t>(dice.whole(-rough, rough));
                block->gain[i] = even ? unit_node_gain : static_cast<uint16_t>(dice.whole(0, 65535));
                if (options.orbits && !even)
                    block->orbit[i] = static_cast<uint16_t>(dice.whole(unit_node_orbit, 65535));
            }
            field->set(std::move(block));
        }
    if (base) field->set_base(base);
    return field;
}

void random_shape(Dice& dice, WaveTrainBox& box, const RandomSeaOptions& options, double heading) {
    box.ux = static_cast<int32_t>(std::lround(std::cos(heading) * 1073741824.0));
    box.uz = static_cast<int32_t>(std::lround(std::sin(heading) * 1073741824.0));
    const int64_t reach = options.extent;
    box.origin = {options.centre.x + dice.whole(-reach, reach), options.centre.z + dice.whole(-reach, reach)};
    box.length = options.unlimited && dice.one_in(4) ? 0 : dice.whole(20'000, 2 * reach);
    box.width = options.unlimited && dice.one_in(4) ? 0 : dice.whole(20'000, 2 * reach);
    box.ramp_rear = static_cast<int32_t>(dice.whole(shortest_ramp, 400'000));
    box.ramp_front = static_cast<int32_t>(dice.whole(shortest_ramp, 400'000));
    box.ramp_side = static_cast<int32_t>(dice.whole(shortest_ramp, 400'000));
    box.begin = {dice.whole(-1'000'000, 0)};
    box.build_up_us = dice.one_in(2) ? 0 : dice.whole(0, 50'000'000);
    if (dice.one_in(2) && box.length != 0)
        box.front_speed = static_cast<uint32_t>(dice.whole(20'000, 400'000));
    if (options.moving && dice.one_in(3))
        for (int leg = 0; leg < 2; ++leg) {
            const int64_t from = leg * 20'000'000;
            box.course.push_back({{from},
                                  15'000'000,
                                  {box.origin.x + leg * 5000, box.origin.z - leg * 7000},
                                  static_cast<int32_t>(dice.whole(-500'000, 500'000)),
                                  static_cast<int32_t>(dice.whole(-500'000, 500'000))});
        }
}

void random_effects(Dice& dice, WaveTrainBox& box, const RandomSeaOptions& options, double heading) {
    if (options.irregular && dice.one_in(2)) {
        IrregularHeight& i = box.irregular;
        i.share = static_cast<uint16_t>(dice.whole(1, full_irregularity));
        i.ukx = static_cast<int32_t>(dice.whole(1000, 100'000));
        i.ukz = static_cast<int32_t>(dice.whole(-100'000, 100'000));
        i.vkx = -i.ukz;
        i.vkz = i.ukx;
        i.omega = static_cast<uint64_t>(dice.whole(0, 2'000'000'000'000));
        i.phase_u = static_cast<uint32_t>(dice.whole(0, UINT32_MAX));
        i.phase_v = static_cast<uint32_t>(dice.whole(0, UINT32_MAX));
    }
    if (options.round && box.width != 0 && dice.one_in(2))
        box.roundness = static_cast<uint16_t>(dice.whole(1, full_roundness));
    if (options.noise && dice.one_in(2)) {
        box.noise.amplitude = static_cast<float>(dice.real(0.01, 0.2));
        box.noise.persistence = static_cast<uint16_t>(dice.whole(20'000, 50'000));
        box.noise.octaves = static_cast<uint8_t>(dice.whole(1, 4));
        box.noise.step_log2 = static_cast<uint8_t>(dice.whole(9, 14));
        box.noise.seed = static_cast<uint32_t>(dice.whole(0, UINT32_MAX));
        box.noise.displayed_only = dice.one_in(2);
    }
    if (options.wakes && box.length != 0 && box.width != 0 && dice.one_in(3)) {
        if (box.course.empty()) box.course.push_back({{0}, 15'000'000, box.origin, 0, 0});
        box.course.resize(1);
        // Along u, as a ship's leg goes.
        const double speed = dice.real(20'000.0, 300'000.0);
        box.course[0].vx = static_cast<int32_t>(std::lround(std::cos(heading) * speed));
        box.course[0].vz = static_cast<int32_t>(std::lround(std::sin(heading) * speed));
        box.wake.transverse = static_cast<float>(dice.real(0.1, 1.0));
        box.wake.diverging = static_cast<float>(dice.real(0.1, 1.0));
        box.wake.choppiness = 0.8F;
        box.wake.inverse_length = static_cast<uint32_t>(dice.whole(int64_t{1} << 22, int64_t{1} << 26));
        box.wake.group_speed = static_cast<uint32_t>(dice.whole(20'000, 100'000));
    }
}

}  // namespace

Sea random_sea(uint64_t seed, const RandomSeaOptions& options) {
    Dice dice(seed);
    std::vector<std::shared_ptr<const LandField>> fields;
    if (options.land)
        for (uint32_t id = 1; id <= 4; ++id) {
            // The third lies over the second.
            const bool over = id == 3;
            const uint8_t step = over ? fields[1]->step_log2() : static_cast<uint8_t>(dice.whole(12, 18));
            fields.push_back(random_field(dice, id, options, step, over ? fields[1] : nullptr));
        }
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    uint32_t next_train = 1;
    for (int i = 0; i < options.boxes; ++i) {
        WaveTrainBox box;
        box.id = {static_cast<uint32_t>(i + 1)};
        box.first_train = {next_train};
        const double heading = dice.real(0.0, turn);
        random_shape(dice, box, options, heading);
        random_effects(dice, box, options, heading);
        const auto trains = dice.whole(1, options.trains);
        for (int64_t t = 0; t < trains; ++t) {
            WaveTrain train = random_train(dice, heading);
            if (options.land && !dice.one_in(3))
                train.field = {static_cast<uint32_t>(dice.whole(1, 5))};  // 5: none such
            box.trains.push_back(train);
        }
        if (options.land) box.overlays.push_back({{3}, {2}});
        next_train += static_cast<uint32_t>(trains);
        const auto valid = validate(box);
        EXPECT_TRUE(valid) << "seed " << seed << ": " << (valid ? "" : valid.error().message);
        boxes.push_back(prepare(std::move(box), fields));
    }
    return Sea(std::move(boxes));
}

}  // namespace trochoid
