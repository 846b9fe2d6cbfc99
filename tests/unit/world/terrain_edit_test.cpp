#include "server/world/terrain_edit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "protocol/model/terrain_file.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

/// 129 x 129 samples of 32 m, 4.1 km a side, uneven ground 10 to 30 m deep.
TerrainGrid bay() {
    TerrainGrid grid;
    grid.columns = grid.rows = 129;
    grid.origin_x = grid.origin_z = -64 * 32768;
    for (uint64_t i = 0; i < uint64_t{129} * 129; ++i)
        grid.heights.push_back(static_cast<int16_t>(-320 - static_cast<int64_t>(splitmix64(i) % 640)));
    grid.open_sea_depth = -30 * 1024;
    return grid;
}

ChangeLand wall(double x0, double z0, double x1, double z1) {
    ChangeLand change;
    change.line = {{to_lattice(x0), to_lattice(z0)}, {to_lattice(x1), to_lattice(z1)}};
    return change;
}

double from_line(LatticePoint p, LatticePoint a, LatticePoint b) {
    const double dx = to_metres(b.x - a.x), dz = to_metres(b.z - a.z);
    const double px = to_metres(p.x - a.x), pz = to_metres(p.z - a.z);
    const double t = std::clamp((px * dx + pz * dz) / (dx * dx + dz * dz), 0.0, 1.0);
    return std::hypot(px - t * dx, pz - t * dz);
}

// The obvious twin: every sample, every segment, libm.
TEST(TerrainEdit, RaisesExactlyWhatTheDocumentSays) {
    const TerrainGrid before = bay();
    ChangeLand change = wall(-700.0, -300.0, 500.0, 450.0);
    change.line.push_back({to_lattice(900.0), to_lattice(450.0)});
    change.width = 70.0F;
    change.crest = 2.5F;
    const auto edit = edited(before, change);
    ASSERT_TRUE(edit);
    size_t changed = 0;
    for (int64_t row = 0; row < 129; ++row)
        for (int64_t column = 0; column < 129; ++column) {
            const size_t i = static_cast<size_t>(row * 129 + column);
            const LatticePoint p{before.origin_x + column * 32768, before.origin_z + row * 32768};
            double away = 1e9;
            for (size_t s = 0; s + 1 < change.line.size(); ++s)
                away = std::min(away, from_line(p, change.line[s], change.line[s + 1]));
            const double target = 2.5 - std::max(away - 35.0, 0.0) / 2.0;
            const double expected = std::max(before.heights[i] / 32.0, target);
            EXPECT_NEAR(edit->terrain->heights[i] / 32.0, expected, 1.0 / 64.0 + 1e-9)
                << row << ", " << column;
            if (edit->terrain->heights[i] == before.heights[i]) continue;
            ++changed;
            EXPECT_TRUE(contains(edit->touched, p));
        }
    EXPECT_GT(changed, 100U);
    EXPECT_LT(changed, 1000U) << "the wall is everywhere";
    EXPECT_GE(edit->samples, changed);
    TerrainGrid same = *edit->terrain;
    same.heights = before.heights;
    EXPECT_EQ(same, before) << "only heights change";
}

TEST(TerrainEdit, OutsideTouchedEveryHeightIsAsBefore) {
    const TerrainGrid before = bay();
    for (const ChangeLand& change : {wall(-100.0, 0.0, 300.0, 0.0), wall(1900.0, -100.0, 4000.0, 100.0)}) {
        const auto edit = edited(before, change);
        ASSERT_TRUE(edit);
        int inside = 0;
        for (uint64_t i = 0; i < 20000; ++i) {
            const auto x = static_cast<int64_t>(splitmix64(i) % 12'000'000) - 6'000'000;
            const auto z = static_cast<int64_t>(splitmix64(i + 77777) % 12'000'000) - 6'000'000;
            if (contains(edit->touched, {x, z}))
                ++inside;
            else
                ASSERT_EQ(height_at(*edit->terrain, x, z), height_at(before, x, z)) << x << ", " << z;
        }
        EXPECT_GT(inside, 5);
        EXPECT_LT(inside, 10000);
    }
}

// However thin it is and whichever way it runs, no water passes: along every way across there is ground above still water.
TEST(TerrainEdit, AThinWallClosesTheWaterInEveryDirection) {
    for (int degrees = 0; degrees < 180; degrees += 7) {
        const double c = std::cos(degrees * 0.017453292519943295),
                     s = std::sin(degrees * 0.017453292519943295);
        ChangeLand change = wall(-900.0 * c + 11.0, -900.0 * s + 5.0, 900.0 * c + 11.0, 900.0 * s + 5.0);
        change.width = 1.0F;
        change.crest = 1.0F;
        const auto edit = edited(bay(), change);
        ASSERT_TRUE(edit);
        for (double along = -800.0; along < 800.0; along += 3.7) {
            int32_t highest = INT32_MIN;
            for (double across = -60.0; across <= 60.0; across += 1.0)
                highest =
                    std::max(highest, height_at(*edit->terrain, to_lattice(along * c - across * s + 11.0),
                                                to_lattice(along * s + across * c + 5.0)));
            ASSERT_GT(highest, 0) << degrees << " degrees, " << along << " m along";
        }
    }
}

TEST(TerrainEdit, DiggingIsRaisingUpsideDown) {
    const TerrainGrid before = bay();
    TerrainGrid turned = before;
    for (int16_t& h : turned.heights) h = static_cast<int16_t>(-h);
    ChangeLand raise = wall(-500.0, 100.0, 700.0, -200.0);
    raise.width = 90.0F;
    raise.crest = -5.0F;
    ChangeLand dig = raise;
    dig.crest = 5.0F;
    dig.dig = true;
    const auto raised = edited(before, raise);
    const auto dug = edited(turned, dig);
    ASSERT_TRUE(raised && dug);
    EXPECT_EQ(raised->samples, dug->samples);
    EXPECT_EQ(raised->touched, dug->touched);
    for (size_t i = 0; i < before.heights.size(); ++i)
        ASSERT_EQ(raised->terrain->heights[i], -dug->terrain->heights[i]);
}

TEST(TerrainEdit, TheSameTwiceChangesNothingMore) {
    const ChangeLand change = wall(-500.0, 100.0, 700.0, -200.0);
    const auto once = edited(bay(), change);
    ASSERT_TRUE(once);
    EXPECT_EQ(terrain_hash(*once->terrain), terrain_hash(*edited(bay(), change)->terrain));
    const auto twice = edited(*once->terrain, change);
    ASSERT_FALSE(twice);
    EXPECT_EQ(twice.error().code, ErrorCode::value_out_of_range);
    EXPECT_NE(twice.error().message.find("as high"), std::string::npos);
    EXPECT_FALSE(edited(bay(), wall(1e6, 1e6, 2e6, 1e6))) << "far beside the terrain";
}

TEST(TerrainEdit, HugeFiguresAreCutToWhatSamplesHold) {
    ChangeLand change = wall(-2e6, -2e6, 2e6, 2e6);
    change.width = 2000.0F;
    change.crest = 200.0F;
    const auto edit = edited(bay(), change);
    ASSERT_TRUE(edit);
    EXPECT_EQ(terrain_fault(*edit->terrain), nullptr);
    TerrainGrid coarse = bay();
    coarse.height_step_log2 = 0;  // 1/1024 m: 200 m do not fit
    const auto cut = edited(coarse, change);
    ASSERT_TRUE(cut);
    EXPECT_EQ(*std::max_element(cut->terrain->heights.begin(), cut->terrain->heights.end()), INT16_MAX);
}

TEST(TerrainEdit, BadChangesSayWhatToDo) {
    const ChangeLand good = wall(0.0, 0.0, 100.0, 0.0);
    EXPECT_TRUE(validate(good));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto refused = [&](auto change_one) {
        ChangeLand change = good;
        change_one(change);
        const auto ok = validate(change);
        return !ok && ok.error().code == ErrorCode::value_out_of_range &&
               ok.error().message.find(": ") != std::string::npos;
    };
    EXPECT_TRUE(refused([](ChangeLand& c) { c.line.clear(); }));
    EXPECT_TRUE(refused([](ChangeLand& c) { c.line.resize(1); }));
    EXPECT_TRUE(refused([](ChangeLand& c) { c.line.resize(65); }));
    EXPECT_TRUE(refused([](ChangeLand& c) { c.line[1].x = world_bound + 1; }));
    for (const float width : {0.0F, -5.0F, 2001.0F, nan})
        EXPECT_TRUE(refused([&](ChangeLand& c) { c.width = width; })) << width;
    for (const float crest : {-201.0F, 201.0F, nan})
        EXPECT_TRUE(refused([&](ChangeLand& c) { c.crest = crest; })) << crest;
}

}  // namespace
}  // namespace trochoid
