#include "protocol/codec/plane_coding.hpp"

#include <gtest/gtest.h>

#include "tests/unit/codec/random_messages.hpp"

namespace trochoid {
namespace {

template <class T>
void expect_round_trip(const std::vector<T>& values, size_t columns) {
    Bytes bytes;
    append_plane(bytes, std::span<const T>(values), columns);
    std::vector<T> back(values.size());
    std::span<const uint8_t> in(bytes);
    ASSERT_TRUE(read_plane(in, std::span<T>(back), columns));
    EXPECT_TRUE(in.empty());
    EXPECT_EQ(back, values);
    for (size_t cut = 0; cut < bytes.size(); ++cut) {
        std::span<const uint8_t> part(bytes.data(), cut);
        EXPECT_FALSE(read_plane(part, std::span<T>(back), columns))
            << cut << " of " << bytes.size() << " bytes";
    }
}

TEST(PlaneCoding, AnyValuesComeBack) {
    Dice dice(11);
    for (int i = 0; i < 50; ++i) {
        std::vector<int32_t> wide(35);
        std::vector<int16_t> narrow(35);
        std::vector<uint16_t> positive(35);
        for (size_t k = 0; k < wide.size(); ++k) {
            wide[k] = dice.coin() ? dice.any<int32_t>() : dice.coin() ? INT32_MIN : INT32_MAX;
            narrow[k] = dice.any<int16_t>();
            positive[k] = dice.between(0, 3) == 0 ? dice.any<uint16_t>() : uint16_t{32768};
        }
        expect_round_trip(wide, 7);
        expect_round_trip(narrow, 5);
        expect_round_trip(positive, 7);
    }
}

TEST(PlaneCoding, KnownBytes) {
    // Predictions: 0, left; up, left + up - up-left. Residuals 1, -1; 0, 0 → zigzag 2, 1; one run of two.
    Bytes bytes;
    const int16_t values[] = {1, 0, 1, 0};
    append_plane(bytes, std::span<const int16_t>(values), 2);
    EXPECT_EQ(bytes, (Bytes{2, 1, 0, 1}));
    // A slope along both axes costs its start and its two steps only.
    std::vector<int32_t> slope;
    for (int32_t z = 0; z < 17; ++z)
        for (int32_t x = 0; x < 17; ++x) slope.push_back(300 + 5 * x - 1000 * z);
    bytes.clear();
    append_plane(bytes, std::span<const int32_t>(slope), 17);
    EXPECT_EQ(bytes.size(), 2U + 16U + 16U * 2U + 16U * 2U);
}

TEST(PlaneCoding, OnlyTheOneShortestFormIsRead) {
    const auto readable = [](const Bytes& bytes) {
        std::array<int16_t, 4> values{};
        std::span<const uint8_t> in(bytes);
        return read_plane(in, std::span<int16_t>(values), 2);
    };
    EXPECT_TRUE(readable({0, 3}));
    EXPECT_FALSE(readable({0, 4})) << "a run beyond the plane";
    EXPECT_FALSE(readable({0, 1, 0, 1})) << "one run written as two";
    EXPECT_FALSE(readable({0x82, 0x00, 1, 0, 1})) << "a longer varint than need be";
    EXPECT_FALSE(readable({0xff, 0xff, 0xff, 0xff, 0xff, 1, 2, 2, 2})) << "a varint of more than five bytes";
    EXPECT_FALSE(readable({0xff, 0xff, 0x07, 0, 2})) << "a value beyond int16";
}

TEST(PlaneCoding, ASmoothBlockTakesAFewHundredBytesAndTheWorstStaysBelow3400) {
    LandBlock smooth;
    LandBlock worst;
    LandBlock shoal;
    for (int i = 0; i < block_nodes * block_nodes; ++i) {
        const int x = i % block_nodes;
        const int z = i / block_nodes;
        const auto at = static_cast<size_t>(i);
        smooth.shift[at] = 4 * x * x + 3 * x * z + 1000 * z;
        smooth.gain[at] = static_cast<uint16_t>(unit_node_gain + 20 * x * x - 7 * z * z);
        worst.shift[at] = (x + z) % 2 == 0 ? 4194303 : -4194303;
        worst.gain[at] = (x + z) % 2 == 0 ? 65535 : 0;
        shoal.orbit[at] = static_cast<uint16_t>(unit_node_orbit + 9 * x * x + 5 * z);
        worst.orbit[at] = (x + z) % 2 == 0 ? 65535 : 0;
    }
    ASSERT_TRUE(validate(smooth));
    ASSERT_TRUE(validate(worst));
    EXPECT_LT(code_nodes(smooth).size(), 640U);
    EXPECT_LT(code_nodes(worst).size(), 3400U);
    shoal.shift = smooth.shift;
    shoal.gain = smooth.gain;
    EXPECT_LT(code_nodes(shoal).size(), code_nodes(smooth).size() + 330U) << "orbits";
    for (const LandBlock& block : {smooth, worst, shoal}) {
        LandBlock back;
        ASSERT_TRUE(read_nodes(code_nodes(block), back));
        EXPECT_EQ(back, block);
    }
    LandBlock trivial_block;
    trivial_block.gain.fill(unit_node_gain);
    EXPECT_LE(code_nodes(trivial_block).size(), 9U);
}

TEST(PlaneCoding, TheRoughestTerrainTileFitsAFrame) {
    TerrainTile tile;
    for (int i = 0; i < 65 * 65; ++i)
        tile.heights.push_back((i % 65 + i / 65) % 2 == 0 ? INT16_MAX : INT16_MIN);
    const Bytes bytes = code_heights(tile);
    EXPECT_LT(bytes.size(), 13000U);
    TerrainTile back;
    ASSERT_TRUE(read_heights(bytes, back));
    EXPECT_EQ(back.heights, tile.heights);
}

}  // namespace
}  // namespace trochoid
