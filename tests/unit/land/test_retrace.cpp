#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "server/land/land_memory.hpp"
#include "server/land/land_retrace.hpp"
#include "server/land/land_trace.hpp"
#include "tests/unit/land/coasts.hpp"

namespace trochoid {
namespace {

TerrainGrid islands() {
    return coast(257, 15, 60, [](double x, double z) {
        const double a = (500.0 - std::hypot(x + 700.0, z - 300.0)) / 20.0;
        const double b = (300.0 - std::hypot(x - 900.0, z + 500.0)) / 20.0;
        return std::clamp(std::max(a, b), -60.0, 30.0);
    });
}

WaveTrainBox sea_of(double heading, double length, double width) {
    WaveTrainBox b = box(heading, length, width);
    b.trains = {train(heading, 90.0, 0.6), train(heading + 14.0, 45.0, 0.3),
                train(heading - 20.0, 22.0, 0.1)};
    return b;
}

/// Sets samples within half a width of the line from a to b (metres) to `height` metres; tells the samples' rectangle.
LatticeRect build(TerrainGrid& terrain, LatticePoint a, LatticePoint b, double half_width, double height) {
    LatticeRect changed{{INT64_MAX, INT64_MAX}, {INT64_MIN, INT64_MIN}};
    for (uint32_t row = 0; row < terrain.rows; ++row)
        for (uint32_t column = 0; column < terrain.columns; ++column) {
            const LatticePoint at{terrain.origin_x + (int64_t{column} << terrain.spacing_log2),
                                  terrain.origin_z + (int64_t{row} << terrain.spacing_log2)};
            const double x = to_metres(at.x);
            const double z = to_metres(at.z);
            const double dx = static_cast<double>(b.x - a.x);
            const double dz = static_cast<double>(b.z - a.z);
            const double ax = static_cast<double>(a.x);
            const double az = static_cast<double>(a.z);
            const double t = std::clamp(((x - ax) * dx + (z - az) * dz) / (dx * dx + dz * dz), 0.0, 1.0);
            if (std::hypot(x - ax - t * dx, z - az - t * dz) > half_width) continue;
            terrain.heights[row * terrain.columns + column] =
                static_cast<int16_t>(std::lround(height * 32.0));
            changed.min = {std::min(changed.min.x, at.x), std::min(changed.min.z, at.z)};
            changed.max = {std::max(changed.max.x, at.x), std::max(changed.max.z, at.z)};
        }
    return changed;
}

/// Null stands for open water.
const LandBlock* water(const LandField* field, BlockKey key) {
    const LandBlock* block = field != nullptr ? field->find(key) : nullptr;
    return block != nullptr && trivial(*block) ? nullptr : block;
}

/// What the trains see is the same, bit by bit, wherever it comes from.
void expect_same_sea(const WaveTrainBox& b, const TracedLand& whole, const TracedLand& changed) {
    ASSERT_TRUE(whole.memory && changed.memory);
    const LandMemory& a = *whole.memory;
    const LandMemory& c = *changed.memory;
    ASSERT_EQ(a.fields.size(), c.fields.size());
    for (size_t band = 0; band < a.fields.size(); ++band)
        for (int32_t z = a.area.first.z; z < a.area.first.z + a.area.blocks_z; ++z)
            for (int32_t x = a.area.first.x; x < a.area.first.x + a.area.blocks_x; ++x) {
                const LandBlock* left = water(a.fields[band].get(), {x, z});
                const LandBlock* right = water(c.fields[band].get(), {x, z});
                ASSERT_EQ(left == nullptr, right == nullptr) << "band " << band << " block " << x << " " << z;
                if (left != nullptr) {
                    ASSERT_EQ(*left, *right) << "band " << band << " block " << x << " " << z;
                }
            }
    for (size_t i = 0; i < b.trains.size(); ++i) {
        const FieldId id = changed.field_of_train.empty() ? FieldId{} : changed.field_of_train[i];
        size_t band = 0;
        while (std::find(c.bands[band].trains.begin(), c.bands[band].trains.end(), i) ==
               c.bands[band].trains.end())
            ++band;
        EXPECT_EQ(id, c.fields[band] ? c.fields[band]->id() : FieldId{});
    }
    EXPECT_EQ(whole.gain_max, changed.gain_max);
    EXPECT_EQ(whole.steepness_growth, changed.steepness_growth);
    EXPECT_EQ(whole.steepness_growth_most, changed.steepness_growth_most);
    EXPECT_EQ(whole.rays, changed.rays);
}

TEST(Retrace, ABreakwaterIsADelta) {
    const TerrainGrid before = islands();
    const WaveTrainBox b = sea_of(20.0, 7000.0, 6000.0);
    const TracedLand old = trace_land(b, before, {1}, LandSettings{});
    TerrainGrid after = before;
    const LatticeRect changed = build(after, {1500, -400}, {1500, 700}, 40.0, 4.0);
    RetraceStats stats;
    const TracedLand land = retrace_land(b, old, before, after, changed, {10}, LandSettings{}, &stats);
    expect_same_sea(b, trace_land(b, after, {1}, LandSettings{}), land);
    EXPECT_FALSE(stats.whole);
    EXPECT_EQ(stats.bands, 3U);
    EXPECT_EQ(stats.bands_changed, land.fields.size());
    EXPECT_LT(stats.rows_marched, stats.rows * 3 / 4);
    EXPECT_LT(stats.rays_walked, stats.rays / 3);
    EXPECT_LT(stats.blocks_changed, stats.blocks_compared);
    // Of all blocks only those that the march reaches with other values are looked at.
    const LandArea& area = old.memory->area;
    EXPECT_LT(stats.blocks_compared,
              static_cast<uint64_t>(area.blocks_x) * static_cast<uint64_t>(area.blocks_z) * 3 / 4);
    ASSERT_EQ(land.overlays.size(), land.fields.size());
    for (size_t i = 0; i < land.overlays.size(); ++i) {
        EXPECT_EQ(land.overlays[i].field, land.fields[i]->id());
        EXPECT_EQ(land.fields[i]->id().value, 10 + i);
        EXPECT_LT(land.overlays[i].base.value, 10U);
        ASSERT_TRUE(land.fields[i]->base());
        EXPECT_EQ(land.fields[i]->base()->id(), land.overlays[i].base);
    }
}

TEST(Retrace, ManyEditsOneAfterTheOther) {
    std::mt19937 random(7);
    const auto between = [&](double least, double most) {
        return least + (most - least) * static_cast<double>(random() >> 8) * 0x1p-24;
    };
    const std::vector<LandSettings> choices = [] {
        LandSettings s;
        s.threads = 1;
        std::vector<LandSettings> all{s};
        s.diffraction = Diffraction::parabolic;
        s.shallow_orbits = true;
        all.push_back(s);
        s.diffraction = Diffraction::none;
        s.refraction = Refraction::straight;
        s.rows_per_node = 2;
        s.breaking_ratio = 0.0;
        s.steepness_max = 0.1;
        all.push_back(s);
        // Waves that break everywhere: nodes are lowered across the blocks' borders.
        s = {};
        s.steepness_max = 0.1;
        s.step_log2 = 14;
        all.push_back(s);
        return all;
    }();
    for (const LandSettings& settings : choices) {
        for (const double heading : {20.0, 90.0, -131.0}) {
            const WaveTrainBox b = sea_of(heading, 7000.0, 6000.0);
            TerrainGrid terrain = islands();
            TracedLand land = trace_land(b, terrain, {1}, settings);
            uint32_t next = 50;
            for (int edit = 0; edit < 4; ++edit) {
                TerrainGrid after = terrain;
                const LatticePoint a{static_cast<int64_t>(between(-3500, 3500)),
                                     static_cast<int64_t>(between(-3500, 3500))};
                const LatticePoint to{a.x + static_cast<int64_t>(between(-900, 900)),
                                      a.z + static_cast<int64_t>(between(-900, 901))};
                const LatticeRect changed = build(after, a, to, 50.0, edit == 2 ? -60.0 : 3.0);
                land = retrace_land(b, land, terrain, after, changed, {next}, settings);
                next += static_cast<uint32_t>(land.fields.size());
                terrain = after;
                expect_same_sea(b, trace_land(b, terrain, {1}, settings), land);
            }
        }
    }
}

TEST(Retrace, DiggingLandAwayLeavesOpenWaterExplicitly) {
    TerrainGrid before =
        coast(129, 15, 60, [](double x, double z) { return std::hypot(x, z) < 200.0 ? 5.0 : -60.0; });
    WaveTrainBox b = box(0.0, 3000.0, 3000.0);
    b.trains = {train(0.0, 30.0, 0.2)};
    const TracedLand old = trace_land(b, before, {1}, LandSettings{});
    ASSERT_EQ(old.fields.size(), 1U);
    TerrainGrid after = before;
    const LatticeRect changed = build(after, {-300, 0}, {300, 0}, 300.0, -60.0);
    RetraceStats stats;
    const TracedLand land = retrace_land(b, old, before, after, changed, {2}, LandSettings{}, &stats);
    ASSERT_EQ(land.fields.size(), 1U);
    EXPECT_EQ(land.fields[0]->block_count(), old.fields[0]->block_count());
    for (const auto& block : land.fields[0]->blocks()) EXPECT_TRUE(trivial(*block));
    EXPECT_EQ(land.field_of_train, std::vector<FieldId>{{2}});
    EXPECT_EQ(land.gain_max, unit_node_gain);
    EXPECT_EQ(land.fields[0]->sample({0, 0}), LandSample{});
    // And back again.
    const TracedLand again = retrace_land(b, land, after, before, changed, {3}, LandSettings{});
    expect_same_sea(b, old, again);
}

TEST(Retrace, WhatTheChangeDoesNotTouchStays) {
    const TerrainGrid before = islands();
    const WaveTrainBox b = sea_of(0.0, 7000.0, 6000.0);
    const TracedLand old = trace_land(b, before, {1}, LandSettings{});
    // 20 m of water are deep for the shortest band, and 36 m for the middle one.
    TerrainGrid after = before;
    const LatticeRect changed = build(after, {-2500, 2000}, {-2300, 2000}, 40.0, -46.0);
    RetraceStats stats;
    const TracedLand land = retrace_land(b, old, before, after, changed, {10}, LandSettings{}, &stats);
    EXPECT_GT(stats.changed_nodes, 0U);
    EXPECT_EQ(stats.bands_traced, 1U);
    ASSERT_EQ(land.fields.size(), 1U);
    EXPECT_EQ(land.field_of_train,
              (std::vector<FieldId>{{10}, old.field_of_train[1], old.field_of_train[2]}));
    expect_same_sea(b, trace_land(b, after, {1}, LandSettings{}), land);
    // Behind the box's rear side nothing counts at all.
    TerrainGrid behind = before;
    const LatticeRect far = build(behind, {-3900, 0}, {-3800, 0}, 40.0, 5.0);
    const TracedLand same = retrace_land(b, old, before, behind, far, {10}, LandSettings{}, &stats);
    EXPECT_EQ(stats.bands_traced, 0U);
    EXPECT_EQ(stats.rays_walked, 0U);
    EXPECT_TRUE(same.fields.empty());
    EXPECT_EQ(same.field_of_train, old.field_of_train);
    expect_same_sea(b, old, same);
}

TEST(Retrace, TheBorderMovesTheBelt) {
    const TerrainGrid before = islands();
    const WaveTrainBox b = sea_of(170.0, 16000.0, 6000.0);
    const TracedLand old = trace_land(b, before, {1}, LandSettings{});
    TerrainGrid after = before;
    const LatticeRect changed = build(after, {-4096, -500}, {-4096, 300}, 20.0, 4.0);
    const TracedLand land = retrace_land(b, old, before, after, changed, {10}, LandSettings{});
    expect_same_sea(b, trace_land(b, after, {1}, LandSettings{}), land);
}

TEST(Retrace, AnotherBoxIsTracedWhole) {
    const TerrainGrid before = islands();
    const WaveTrainBox b = sea_of(20.0, 7000.0, 6000.0);
    const TracedLand old = trace_land(b, before, {1}, LandSettings{});
    WaveTrainBox other = b;
    other.origin.x += 5000 * 1024;
    TerrainGrid after = before;
    const LatticeRect changed = build(after, {1500, -400}, {1500, 700}, 40.0, 4.0);
    RetraceStats stats;
    const TracedLand land = retrace_land(other, old, before, after, changed, {10}, LandSettings{}, &stats);
    EXPECT_TRUE(stats.whole);
    EXPECT_TRUE(land.overlays.empty());
    EXPECT_EQ(hash_of(land), hash_of(trace_land(other, after, {10}, LandSettings{})));
}

}  // namespace
}  // namespace trochoid
