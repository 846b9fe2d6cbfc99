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

TEST(LandField, ValidationBoundsShiftsAndTheirSteps) {
    LandBlock block;
    block.gain.fill(unit_node_gain);
    EXPECT_TRUE(trivial(block));
    EXPECT_TRUE(validate(block).has_value());
    block.shift[5] = 1 << 23;
    EXPECT_FALSE(trivial(block));
    EXPECT_FALSE(validate(block).has_value());
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
