#include "protocol/model/land_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "protocol/model/self_check.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

std::shared_ptr<const LandField> hills() { return reference_sea().boxes()[1]->fields[0]; }

/// The slow twin: bilinear in doubles over the nodes.
struct Twin {
    double shift = 0.0;  // 2^-16 turns
    double gain = 1.0;
};
Twin twin(const LandField& field, LatticePoint p) {
    const double cell = static_cast<double>(int64_t{1} << field.step_log2());
    const double x = static_cast<double>(p.x) / cell;
    const double z = static_cast<double>(p.z) / cell;
    const auto node_x = static_cast<int64_t>(std::floor(x));
    const auto node_z = static_cast<int64_t>(std::floor(z));
    const auto node = [&](int64_t nx, int64_t nz) {
        const BlockKey key{static_cast<int32_t>(std::floor(static_cast<double>(node_x) / 16)),
                           static_cast<int32_t>(std::floor(static_cast<double>(node_z) / 16))};
        const LandBlock* block = field.find(key);
        if (block == nullptr) return Twin{};
        const auto i = static_cast<size_t>((nz - key.z * 16) * block_nodes + (nx - key.x * 16));
        return Twin{static_cast<double>(block->shift[i]), block->gain[i] / 32768.0};
    };
    const double fx = x - static_cast<double>(node_x);
    const double fz = z - static_cast<double>(node_z);
    const Twin a = node(node_x, node_z);
    const Twin b = node(node_x + 1, node_z);
    const Twin c = node(node_x, node_z + 1);
    const Twin d = node(node_x + 1, node_z + 1);
    const auto mix = [&](double p00, double p10, double p01, double p11) {
        return (p00 * (1 - fx) + p10 * fx) * (1 - fz) + (p01 * (1 - fx) + p11 * fx) * fz;
    };
    return {mix(a.shift, b.shift, c.shift, d.shift), mix(a.gain, b.gain, c.gain, d.gain)};
}

TEST(LandField, AgreesWithTheBilinearTwinEverywhere) {
    const auto field = hills();
    int touched = 0;
    for (uint64_t i = 0; i < 20'000; ++i) {
        const LatticePoint p{static_cast<int64_t>(splitmix64(i) % 5'000'000) - 2'500'000,
                             static_cast<int64_t>(splitmix64(~i) % 5'000'000) - 2'500'000};
        const LandSample s = field->sample(p);
        const Twin t = twin(*field, p);
        const double turns = t.shift / 65536.0;
        const double error = std::remainder(s.shift / 4294967296.0 - turns, 1.0);
        EXPECT_LE(std::abs(error), 4e-5) << p.x << ' ' << p.z;
        EXPECT_NEAR(s.gain / 16777216.0, t.gain, 1e-6);
        if (t.shift != 0.0) ++touched;
    }
    EXPECT_GT(touched, 5000);
}

TEST(LandField, IsContinuousAcrossCellsAndBlocks) {
    const auto field = hills();
    for (int64_t border = -2 * 16; border <= 15; ++border) {
        const int64_t x = border * 65536;
        const LandSample before = field->sample({x - 1, 12'345});
        const LandSample after = field->sample({x, 12'345});
        if (x == -2 * 16 * 65536) continue;  // the reference field's own outer edge is not trivial
        const auto step = static_cast<int32_t>(after.shift - before.shift);
        EXPECT_LE(std::abs(step), 1 << 22) << border;
        EXPECT_LE(std::abs(static_cast<int64_t>(after.gain) - static_cast<int64_t>(before.gain)), 4000)
            << border;
    }
}

TEST(LandField, OrbitsAreBilinearWithTheGradientAsEvaluated) {
    const auto field = reference_sea().boxes()[2]->fields[1];  // field 2 alone
    ASSERT_EQ(field->id(), FieldId{2});
    ASSERT_EQ(field->base(), nullptr);
    const double cell = static_cast<double>(int64_t{1} << field->step_log2());
    int touched = 0;
    for (uint64_t i = 0; i < 20'000; ++i) {
        const LatticePoint p{static_cast<int64_t>(splitmix64(i) % 1'400'000) - 700'000,
                             static_cast<int64_t>(splitmix64(~i) % 1'400'000) - 700'000};
        const LandSample s = field->sample(p);
        const double x = static_cast<double>(p.x) / cell;
        const double z = static_cast<double>(p.z) / cell;
        const auto orbit = [&](int dx, int dz) {
            const auto nx = static_cast<int64_t>(std::floor(x));
            const auto nz = static_cast<int64_t>(std::floor(z));
            const LandBlock* b = field->find({static_cast<int32_t>(nx >> 4), static_cast<int32_t>(nz >> 4)});
            if (b == nullptr) return 1.0;
            return b->orbit[static_cast<size_t>(((nz & 15) + dz) * block_nodes + (nx & 15) + dx)] / 16384.0;
        };
        const double fx = x - std::floor(x);
        const double fz = z - std::floor(z);
        const double truth = (orbit(0, 0) * (1 - fx) + orbit(1, 0) * fx) * (1 - fz) +
                             (orbit(0, 1) * (1 - fx) + orbit(1, 1) * fx) * fz;
        EXPECT_NEAR(static_cast<double>(s.orbit), truth, 2e-6);
        const double dx = ((orbit(1, 0) - orbit(0, 0)) * (1 - fz) + (orbit(1, 1) - orbit(0, 1)) * fz) / 32.0;
        const double dz = ((orbit(0, 1) - orbit(0, 0)) * (1 - fx) + (orbit(1, 1) - orbit(1, 0)) * fx) / 32.0;
        EXPECT_NEAR(static_cast<double>(s.dorbit_dx), dx, 1e-6);
        EXPECT_NEAR(static_cast<double>(s.dorbit_dz), dz, 1e-6);
        if (truth != 1.0) ++touched;
    }
    EXPECT_GT(touched, 5000);
}

std::shared_ptr<const LandBlock> plain_block(int32_t x, uint16_t gain) {
    auto block = std::make_shared<LandBlock>();
    block->key = {x, 0};
    block->gain.fill(gain);
    return block;
}

std::shared_ptr<LandField> plain_field(uint32_t id, uint8_t step, std::initializer_list<int32_t> blocks,
                                       uint16_t gain) {
    auto field = std::make_shared<LandField>(FieldId{id}, step);
    for (const int32_t x : blocks) field->set(plain_block(x, gain));
    return field;
}

TEST(LandField, WhereItHasNoBlockItsBaseCounts) {
    const auto bottom = plain_field(1, 12, {0, 1, 2, 3}, 10'000);
    const auto middle = plain_field(2, 12, {1, 2}, 20'000);
    const auto top = plain_field(5, 12, {2}, 30'000);
    middle->set_base(bottom);
    top->set_base(middle);
    const auto gain = [](const LandField& f, int32_t block) {
        return f.sample({block * 65536 + 77, 99}).gain;
    };
    EXPECT_EQ(gain(*top, 0), 10'000U << 9);
    EXPECT_EQ(gain(*top, 1), 20'000U << 9);
    EXPECT_EQ(gain(*top, 2), 30'000U << 9);
    EXPECT_EQ(gain(*top, 3), 10'000U << 9);
    EXPECT_EQ(gain(*top, 4), 1U << 24);
    EXPECT_EQ(top->share({1, 0}), middle->share({1, 0}));
    EXPECT_EQ(top->find({3, 0}), bottom->find({3, 0}));
    EXPECT_EQ(top->share({9, 0}), nullptr);
    EXPECT_EQ(top->block_count(), 1U);
    EXPECT_EQ(top->blocks().size(), 1U);
    top->set_base(nullptr);
    EXPECT_EQ(gain(*top, 0), 1U << 24);
}

TEST(LandField, ABaseOfAnotherStepOrALaterFieldIsOurBug) {
    const auto field = plain_field(3, 12, {0}, 1);
    EXPECT_DEATH(field->set_base(plain_field(1, 13, {0}, 1)), "assertion failed");
    EXPECT_DEATH(field->set_base(plain_field(3, 12, {0}, 1)), "assertion failed");
}

TEST(Overlays, JoinFieldsAsTheRecordSaysInAnyOrder) {
    WaveTrainBox box = reference_sea().boxes()[0]->record;
    box.trains[0].field = {5};
    box.trains[1].field = {2};
    box.overlays = {{{2}, {1}}, {{5}, {2}}};
    ASSERT_TRUE(validate(box).has_value());
    const std::shared_ptr<const LandField> fields[] = {
        plain_field(5, 12, {2}, 30'000), plain_field(9, 12, {0}, 9), plain_field(1, 12, {0, 1, 2}, 10'000),
        plain_field(2, 12, {1, 2}, 20'000)};
    const auto gain = [](const PreparedBox& p, size_t train, int32_t block) {
        return p.fields[static_cast<size_t>(p.field_of_train[train])]->sample({block * 65536 + 5, 7}).gain >>
               9;
    };
    const auto whole = prepare(box, fields);
    EXPECT_EQ(gain(*whole, 0, 0), 10'000U);
    EXPECT_EQ(gain(*whole, 0, 1), 20'000U);
    EXPECT_EQ(gain(*whole, 0, 2), 30'000U);
    EXPECT_EQ(gain(*whole, 1, 0), 10'000U);
    EXPECT_EQ(gain(*whole, 1, 2), 20'000U);
    // A changed field of which nothing is known yet reads as what was before; a base of another step does not count.
    const auto part = prepare(box, std::span(fields).subspan(1));
    EXPECT_EQ(gain(*part, 0, 2), 20'000U);
    const std::shared_ptr<const LandField> odd[] = {plain_field(5, 12, {2}, 30'000),
                                                    plain_field(2, 13, {0}, 3)};
    EXPECT_EQ(gain(*prepare(box, odd), 0, 0), 32'768U);
    // The given fields themselves are not touched.
    EXPECT_EQ(fields[0]->base(), nullptr);
}

TEST(LandField, WithoutABlockReadsShift0Gain1) {
    const LandField empty(FieldId{9}, 16);
    EXPECT_EQ(empty.sample({5, 6}), LandSample{});
    EXPECT_EQ(hills()->sample({40'000'000, 0}), LandSample{});
}

TEST(LandField, BlocksMayComeInAnyOrderAndBeReplaced) {
    const auto from = hills();
    LandField field(FieldId{1}, 16);
    auto blocks = from->blocks();
    for (size_t i = blocks.size(); i-- > 0;) field.set(blocks[i]);
    field.set(blocks[3]);
    EXPECT_EQ(field.block_count(), blocks.size());
    for (const auto& block : blocks) EXPECT_EQ(field.find(block->key), block.get());
    EXPECT_EQ(field.sample({77'777, -88'888}), from->sample({77'777, -88'888}));
}

TEST(LandField, RefusesAWindowThatWouldEatTheMemory) {
    LandField field(FieldId{1}, 12);
    auto block = std::make_shared<LandBlock>();
    field.set(block);
    EXPECT_TRUE(field.fits({1000, 1000}));
    EXPECT_FALSE(field.fits({std::numeric_limits<int32_t>::max(), std::numeric_limits<int32_t>::min()}));
}

TEST(LandField, ACopySharesTheWindowUntilOneOfThemSets) {
    const auto first = plain_field(1, 12, {0, 3}, 10'000);
    LandField copy(*first);
    EXPECT_EQ(copy.slot_count(), 4U);
    copy.set(plain_block(0, 20'000));
    copy.set(plain_block(5, 20'000));
    EXPECT_EQ(first->sample({77, 99}).gain, 10'000U << 9);
    EXPECT_EQ(copy.sample({77, 99}).gain, 20'000U << 9);
    EXPECT_EQ(first->block_count(), 2U);
    EXPECT_EQ(copy.block_count(), 3U);
    EXPECT_EQ(first->find({5, 0}), nullptr);
    EXPECT_EQ(copy.find({3, 0}), first->find({3, 0}));
    EXPECT_EQ(first->slot_count(), 4U);
}

TEST(LandField, RoomThatIsMadeAheadHoldsNothing) {
    LandField field(FieldId{1}, 12);
    field.make_room({-3, 2}, {4, 5});
    EXPECT_EQ(field.slot_count(), 32U);
    EXPECT_EQ(field.block_count(), 0U);
    EXPECT_TRUE(field.blocks().empty());
    EXPECT_EQ(field.sample({5, 6}), LandSample{});
    field.set(plain_block(0, 7));
    EXPECT_EQ(field.slot_count(), 48U) << "row 0 was not in it";
    EXPECT_EQ(field.block_count(), 1U);
}

TEST(LandField, ValidationBoundsShiftsAndTheirSteps) {
    LandBlock block;
    block.gain.fill(unit_node_gain);
    EXPECT_TRUE(trivial(block));
    EXPECT_TRUE(validate(block).has_value());
    block.shift[5] = 1 << 23;
    EXPECT_FALSE(trivial(block));
    EXPECT_FALSE(validate(block).has_value());
    block.shift.fill(0);
    EXPECT_TRUE(trivial(block));
    block.orbit[7] = unit_node_orbit + 1;
    EXPECT_FALSE(trivial(block));
    EXPECT_TRUE(validate(block).has_value());
    block.shift.fill(1 << 30);
    EXPECT_FALSE(validate(block).has_value());
}

TEST(LandField, BlocksTouchingCoverTheRectangle) {
    const BlockRange r = blocks_touching({{-1, 0}, {1 << 20, (1 << 20) - 1}}, 16);
    EXPECT_EQ(r.first, (BlockKey{-1, 0}));
    EXPECT_EQ(r.last, (BlockKey{1, 0}));
}

}  // namespace
}  // namespace trochoid
