#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "server/land/depth_response.hpp"
#include "server/land/depth_table.hpp"
#include "server/land/plane_sampler.hpp"
#include "server/land/tile_marks.hpp"

namespace trochoid {
namespace {

TEST(TileMarks, SpreadReachesTheEightNeighbours) {
    TileMarks marks;
    marks.reset(65, 33);
    ASSERT_EQ(marks.tiles_x(), 5);
    ASSERT_EQ(marks.tiles_z(), 3);
    marks.add(31, 16, 1);
    marks.add(64, 32, 2);
    marks.spread(1);
    for (int32_t z = 0; z < 3; ++z)
        for (int32_t x = 0; x < 5; ++x)
            EXPECT_EQ(marks.at(16 * x, 16 * z), (x <= 2 ? 1 : 0) | (x == 4 && z == 2 ? 2 : 0))
                << x << " " << z;
    marks.spread(2);
    EXPECT_EQ(marks.at(63, 31), 2);
    EXPECT_EQ(marks.at(63, 15), 0);
}

TEST(TileMarks, MinimaCountTheLastPartTile) {
    std::vector<float> values(33 * 17, 5.0F);
    values[16 * 33 + 32] = -3.0F;
    values[3 * 33 + 15] = 2.0F;
    EXPECT_EQ(tile_minima(values, 33, 17), (std::vector<float>{2.0F, 5.0F, 5.0F, 5.0F, 5.0F, -3.0F}));
}

TEST(PlaneSampler, EqualsTheScalarFormula) {
    constexpr int32_t side = 50;
    std::mt19937 random(3);
    std::vector<float> plane(side * side);
    for (float& value : plane)
        value = random() % 5 == 0 ? 0.0F : static_cast<float>(random() >> 8) * 0x1p-24F;
    const ObliqueRow row{to_q32(1.25), to_q32(30.6), to_q32(0.96), to_q32(-0.28)};
    for (const IndexRange run : {IndexRange{0, 47}, IndexRange{5, 8}, IndexRange{9, 9}}) {
        PlaneSampler sampler;
        sampler.place(row, run, side);
        std::vector<float> values(48, -1.0F);
        std::vector<float> solid(48, -1.0F);
        sampler.sample(plane.data(), run, values.data());
        sampler.sample_solid(plane.data(), run, solid.data());
        for (int32_t j = 0; j < 48; ++j) {
            const auto at = static_cast<size_t>(j);
            if (j < run.from || j >= run.to) {
                ASSERT_EQ(values[at], -1.0F);
                ASSERT_EQ(solid[at], -1.0F);
                continue;
            }
            const int64_t x = row.x + j * row.dx;
            const int64_t z = row.z + j * row.dz;
            const auto fx = static_cast<float>(static_cast<uint32_t>(x) >> 8) * 0x1p-24F;
            const auto fz = static_cast<float>(static_cast<uint32_t>(z) >> 8) * 0x1p-24F;
            const float* const near = plane.data() + (z >> 32) * side + (x >> 32);
            const float west = near[0] + (near[side] - near[0]) * fz;
            const float east = near[1] + (near[side + 1] - near[1]) * fz;
            ASSERT_EQ(values[at], west + (east - west) * fx) << j;
            const float nearest = near[(fz >= 0.5F ? side : 0) + (fx >= 0.5F ? 1 : 0)];
            ASSERT_EQ(solid[at], nearest == 0.0F ? 0.0F : values[at]) << j;
        }
    }
}

TEST(DepthTable, RowsEqualSingleLookUps) {
    LandSettings settings;
    for (const Shoaling shoaling : {Shoaling::linear, Shoaling::decrease}) {
        settings.shoaling = shoaling;
        const DepthResponse response(1.0 / 120.0, 60.0, 3.0, settings);
        const DepthTable table(response);
        std::vector<float> depths;
        for (float depth = 0.0003F; depth < 90.0F; depth *= 1.013F) depths.push_back(depth);
        depths.insert(depths.end(), {table.deep(), table.untouched(), table.breaking(), 32768.0F});
        std::vector<float> wave_numbers(depths.size());
        table.wave_numbers(depths.data(), depths.size(), 0.25F, wave_numbers.data());
        depths.insert(depths.end(), {-0.0F, 0.0F, -4.0F});
        std::vector<float> growths(depths.size());
        table.growths(depths.data(), depths.size(), growths.data());
        for (size_t i = 0; i < depths.size(); ++i) {
            const float depth = depths[i];
            if (i < wave_numbers.size()) {
                ASSERT_EQ(wave_numbers[i], depth < table.deep() ? 0.25F * table.at(depth)[0] : 0.25F);
            }
            if (depth >= table.untouched()) {
                ASSERT_EQ(growths[i], 1.0F) << depth;
                continue;
            }
            ASSERT_EQ(growths[i], depth > 0.0F ? table.at(depth)[1] : table.land()[1]) << depth;
            if (depth < table.breaking()) continue;
            ASSERT_EQ(table.at(depth)[2], 2.0F) << depth;
            ASSERT_EQ(table.at(depth)[3], 1.0F) << depth;
        }
    }
}

TEST(DepthResponse, AllPassesWhereNothingBreaks) {
    LandSettings settings;
    for (const Shoaling shoaling : {Shoaling::paper, Shoaling::linear, Shoaling::decrease, Shoaling::none})
        for (const double height : {0.05, 1.0, 8.0})
            for (const double wavelength : {5.0, 60.0, 400.0}) {
                settings.shoaling = shoaling;
                const DepthResponse response(1.0 / wavelength, 90.0, height, settings);
                for (double depth = 0.01; depth < 100.0; depth *= 1.02)
                    ASSERT_EQ(response.share_limit(depth),
                              DepthResponse::share_of(response.breaking_gain(depth), response.growth(depth)))
                        << depth;
            }
}

}  // namespace
}  // namespace trochoid
