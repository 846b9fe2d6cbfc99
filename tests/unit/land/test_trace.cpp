#include <gtest/gtest.h>

#include <cmath>

#include "protocol/model/terrain_file.hpp"
#include "server/land/band_trace.hpp"
#include "server/land/land_cache.hpp"
#include "server/land/land_trace.hpp"
#include "tests/unit/land/coasts.hpp"

namespace trochoid {
namespace {

TerrainGrid two_islands() {
    return coast(257, 15, 60, [](double x, double z) {
        const double a = (500.0 - std::hypot(x + 700.0, z - 300.0)) / 20.0;
        const double b = (300.0 - std::hypot(x - 900.0, z + 500.0)) / 20.0;
        return std::clamp(std::max(a, b), -60.0, 30.0);
    });
}

WaveTrainBox sea_of(double heading, double length, double width) {
    WaveTrainBox b = box(heading, length, width);
    b.trains = {train(heading, 90.0, 0.6), train(heading + 14.0, 45.0, 0.3), train(heading - 20.0, 22.0, 0.1),
                train(heading + 3.0, 80.0, 0.2)};
    for (WaveTrain& t : b.trains) t.choppiness = 0.8F;
    return b;
}

void expect_equal(const TracedLand& a, const TracedLand& b) {
    ASSERT_EQ(a.fields.size(), b.fields.size());
    for (size_t i = 0; i < a.fields.size(); ++i) {
        EXPECT_EQ(a.fields[i]->id(), b.fields[i]->id());
        const auto left = a.fields[i]->blocks();
        const auto right = b.fields[i]->blocks();
        ASSERT_EQ(left.size(), right.size());
        for (size_t n = 0; n < left.size(); ++n) ASSERT_EQ(*left[n], *right[n]);
    }
    EXPECT_EQ(a.field_of_train, b.field_of_train);
    EXPECT_EQ(a.gain_max, b.gain_max);
    EXPECT_EQ(a.steepness_growth, b.steepness_growth);
    EXPECT_EQ(a.rays, b.rays);
    EXPECT_EQ(hash_of(a), hash_of(b));
}

TEST(Trace, FieldsAndTrainsAreNumberedInOrder) {
    const TracedLand land = trace_land(sea_of(20.0, 7000.0, 6000.0), two_islands(), {7}, LandSettings{});
    ASSERT_EQ(land.fields.size(), 3U);
    for (uint32_t i = 0; i < 3; ++i) EXPECT_EQ(land.fields[i]->id().value, 7 + i);
    EXPECT_EQ(land.field_of_train, (std::vector<FieldId>{{7}, {8}, {9}, {7}}));
    EXPECT_GE(land.gain_max, unit_node_gain);
    EXPECT_EQ(land.fields[0]->step_log2(), 15);
}

TEST(Trace, ThreadsChangeNothing) {
    const TerrainGrid terrain = two_islands();
    const WaveTrainBox b = sea_of(20.0, 7000.0, 6000.0);
    LandSettings one;
    one.threads = 1;
    LandSettings three;
    three.threads = 3;
    expect_equal(trace_land(b, terrain, {1}, one), trace_land(b, terrain, {1}, three));
}

TEST(Trace, GoldenHash) {
    // The same on every compiler, optimisation level and machine: a change here is another sea.
    TerrainGrid terrain;
    terrain.columns = 65;
    terrain.rows = 65;
    terrain.origin_x = -(int64_t{1} << 20);
    terrain.origin_z = terrain.origin_x;
    for (int row = -32; row <= 32; ++row)
        for (int column = -32; column <= 32; ++column)
            terrain.heights.push_back(
                static_cast<int16_t>(std::max(-1920, 320 - 12 * (row * row + column * column))));
    WaveTrainBox b = open_box(0.0);
    b.ux = 858993459;  // 0.8
    b.uz = 644245094;  // 0.6
    b.length = 3 << 20;
    b.width = 2 << 20;
    b.origin = {-(1 << 20), -(3 << 19)};
    WaveTrain t;
    t.kx = 40000;
    t.kz = 30000;
    t.amplitude = 0.75F;
    t.choppiness = 1.0F;
    b.trains.push_back(t);
    t.kx = 200000;
    t.kz = 100000;
    t.amplitude = 0.125F;
    b.trains.push_back(t);
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    EXPECT_EQ(land.fields.size(), 2U);
    EXPECT_EQ(hash_of(land), 2491507755524606911ULL);
}

TEST(Trace, UpstreamIsExactlyOpenWater) {
    const TerrainGrid terrain = two_islands();
    for (const double heading : {0.0, 30.0, 135.0}) {
        WaveTrainBox b = open_box(heading);
        b.trains = {train(heading, 60.0, 0.5)};
        const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
        const double ux = static_cast<double>(b.ux) * 0x1p-30;
        const double uz = static_cast<double>(b.uz) * 0x1p-30;
        size_t beyond = 0;
        // Water shallower than 60 m begins 1.7 km before the islands' centres.
        for (double u = -8000.0; u < -3200.0; u += 64.0)
            for (double v = -6000.0; v < 6000.0; v += 64.0) {
                const LandSample s =
                    land.fields.at(0)->sample({to_lattice(u * ux - v * uz), to_lattice(u * uz + v * ux)});
                ASSERT_EQ(s, LandSample{}) << u << " " << v;
                ++beyond;
            }
        EXPECT_GT(beyond, 1000U);
    }
}

TEST(Trace, DeepWaterHasNoFields) {
    const TerrainGrid terrain = coast(129, 15, 60, [](double, double) { return -45.0; });
    WaveTrainBox b = box(15.0, 5000.0, 5000.0);
    b.trains = {train(15.0, 44.0, 0.5), train(20.0, 10.0, 0.1)};
    const TracedLand land = trace_land(b, terrain, {1}, LandSettings{});
    EXPECT_TRUE(land.fields.empty());
    EXPECT_TRUE(land.field_of_train.empty());
    EXPECT_EQ(land.gain_max, unit_node_gain);
    EXPECT_EQ(land.steepness_growth, 1.0F);
    EXPECT_EQ(land.rays.size(), 128U);
}

TEST(Trace, OnlyTheBandsThatFeelTheBottomHaveFields) {
    const TerrainGrid terrain =
        coast(129, 15, 60, [](double x, double) { return std::abs(x) < 500.0 ? -20.0 : -60.0; });
    WaveTrainBox b = box(0.0, 5000.0, 5000.0);
    b.trains = {train(0.0, 100.0, 0.5), train(0.0, 15.0, 0.1), train(2.0, 70.0, 0.5)};
    const TracedLand land = trace_land(b, terrain, {3}, LandSettings{});
    ASSERT_EQ(land.fields.size(), 1U);
    EXPECT_EQ(land.field_of_train, (std::vector<FieldId>{{3}, {0}, {3}}));
}

TEST(Trace, BlocksAreValidAndShareTheirEdges) {
    const TracedLand land = trace_land(sea_of(75.0, 9000.0, 6000.0), two_islands(), {1}, LandSettings{});
    size_t edges = 0;
    for (const auto& field : land.fields)
        for (const auto& block : field->blocks()) {
            EXPECT_FALSE(trivial(*block));
            EXPECT_TRUE(validate(*block).has_value());
            const LandBlock* east = field->find({block->key.x + 1, block->key.z});
            const LandBlock* south = field->find({block->key.x, block->key.z + 1});
            for (size_t i = 0; i < block_nodes; ++i) {
                const size_t last = block_nodes - 1;
                if (east != nullptr) {
                    ASSERT_EQ(block->shift[i * block_nodes + last], east->shift[i * block_nodes]);
                    ASSERT_EQ(block->gain[i * block_nodes + last], east->gain[i * block_nodes]);
                    ++edges;
                }
                if (south != nullptr) {
                    ASSERT_EQ(block->shift[last * block_nodes + i], south->shift[i]);
                    ASSERT_EQ(block->gain[last * block_nodes + i], south->gain[i]);
                    ++edges;
                }
            }
        }
    EXPECT_GT(edges, 1000U);
}

TEST(Trace, BlocksEndOnOpenWaterOrOutsideTheBox) {
    const WaveTrainBox b = sea_of(75.0, 40000.0, 6000.0);
    const TracedLand land = trace_land(b, two_islands(), {1}, LandSettings{});
    size_t ends = 0;
    for (const auto& field : land.fields)
        for (const auto& block : field->blocks())
            for (int i = 0; i < block_nodes; ++i) {
                const auto check = [&](BlockKey neighbour, int x, int z) {
                    if (field->find(neighbour) != nullptr) return;
                    const int64_t step = int64_t{1} << field->step_log2();
                    const BoxPosition at = box_position(
                        b, instant_of(b, b.begin),
                        {(int64_t{block->key.x} * 16 + x) * step, (int64_t{block->key.z} * 16 + z) * step});
                    if (at.u <= 0 || at.v <= 0 || at.u >= b.length || at.v >= b.width) return;
                    const auto n = static_cast<size_t>(z * block_nodes + x);
                    ASSERT_EQ(block->shift[n], 0);
                    ASSERT_EQ(block->gain[n], unit_node_gain);
                    ++ends;
                };
                check({block->key.x - 1, block->key.z}, 0, i);
                check({block->key.x + 1, block->key.z}, 16, i);
                check({block->key.x, block->key.z - 1}, i, 0);
                check({block->key.x, block->key.z + 1}, i, 16);
            }
    EXPECT_GT(ends, 100U);
}

TEST(Trace, LandBehindTheRearSideDoesNotMatter) {
    // The box starts half way between an island in the west and open water.
    const TerrainGrid terrain = coast(257, 15, 60, [](double x, double z) {
        return std::clamp((500.0 - std::hypot(x + 3000.0, z)) / 10.0, -60.0, 30.0);
    });
    WaveTrainBox b = box(0.0, 5000.0, 4000.0);
    b.trains = {train(0.0, 50.0, 0.5)};
    b.origin.x = to_lattice(-1200.0);
    EXPECT_TRUE(trace_land(b, terrain, {1}, LandSettings{}).fields.empty());
    b.origin.x = to_lattice(-4000.0);
    EXPECT_FALSE(trace_land(b, terrain, {1}, LandSettings{}).fields.empty());
}

TEST(Trace, LargeAreasTakeCoarserNodes) {
    LandSettings settings;
    settings.nodes_max = 20000;
    LandTraceStats stats;
    const TracedLand land = trace_land(sea_of(0.0, 9000.0, 9000.0), two_islands(), {1}, settings, &stats);
    EXPECT_GT(stats.step_log2, 15);
    EXPECT_LE(stats.nodes_per_band, 20000U);
    EXPECT_EQ(land.fields.at(0)->step_log2(), stats.step_log2);
}

/// Scalar twin of one column of the march in water that is alike across: forward in one loop, no grid, no neighbours.
struct Twin {
    double shift = 0.0;
    double share = 1.0;
};

TEST(Trace, MarchEqualsItsScalarTwinWhereDepthIsAlikeAcross) {
    const auto profile = [](double x) {
        if (x < -1500.0) return -60.0;
        if (x < 0.0) return -60.0 + 64.0 * (x + 1500.0) / 1500.0;
        if (x < 300.0) return 4.0;
        return std::max(-60.0, 4.0 - (x - 300.0) / 10.0);
    };
    const TerrainGrid terrain = coast(257, 15, 60, [&](double x, double) { return profile(x); });
    WaveTrainBox b = open_box(0.0);
    b.trains = {train(0.0, 64.0, 0.7)};
    const LandSettings settings;
    const TraceInput in = trace_input(b, terrain, settings, false);
    const DepthResponse response = response_of(in, in.bands.at(0));
    TraceWorkspace work;
    ASSERT_TRUE(trace_band(in, 0, work, nullptr).touched);
    const BandGrid& grid = work.grid;
    const BandView view = in.view(0);
    ASSERT_TRUE(view.turned);
    const double open = in.bands[0].turns_per_metre * 32.0;
    const int32_t z = in.area.nodes_z() / 2;
    const DepthTable table(response);
    PhaseDepths phase_depths(*view.area, view.depths, view.band, table);
    phase_depths.take({0, view.area->nodes_z()}, {z, z + 1});
    Twin twin;
    double before = open;
    size_t land_nodes = 0;
    // Farther on, the terrain's sides, 4 km off, begin to be felt.
    for (int32_t x = 0; in.area.at(x, z).x < to_lattice(2000.0); ++x) {
        const auto n =
            static_cast<size_t>(x) * static_cast<size_t>(view.area->nodes_x()) + static_cast<size_t>(z);
        const auto depth = static_cast<double>(view.depths[n]);
        const double here = open * response.wave_number(static_cast<double>(*phase_depths.at(z, x)));
        twin.shift += 0.5 * (before + here) - open;
        before = here;
        twin.share = std::min({twin.share + 32.0 / settings.recovery, 1.0, response.share_limit(depth)});
        if (depth <= 0.0) ++land_nodes;
        const double row = grid.row_of(z, x) - grid.first_row;
        const double column = grid.column_of(z, x);
        ASSERT_EQ(row, std::floor(row));
        ASSERT_EQ(column, std::floor(column));
        if (row < 0.0) {
            ASSERT_EQ(twin.share, 1.0);
            ASSERT_NEAR(twin.shift, 0.0, 1e-5);
            continue;
        }
        const size_t at =
            static_cast<size_t>(row) * static_cast<size_t>(grid.columns) + static_cast<size_t>(column);
        ASSERT_NEAR(grid.shift[at], twin.shift, 3e-4) << "node " << x;
        ASSERT_NEAR(grid.shelter[at], twin.share, 3e-5) << "node " << x;
    }
    EXPECT_GT(land_nodes, 8U);
    EXPECT_GT(twin.shift, 3.0);
}

TEST(Trace, FinerRowsChangeLittle) {
    const TerrainGrid terrain = two_islands();
    WaveTrainBox b = box(20.0, 7000.0, 6000.0);
    b.trains = {train(20.0, 90.0, 0.6)};
    LandSettings fine;
    fine.rows_per_node = 4;
    const TracedLand coarse_land = trace_land(b, terrain, {1}, LandSettings{});
    const TracedLand fine_land = trace_land(b, terrain, {1}, fine);
    double sum = 0.0;
    int count = 0;
    for (double z = -3000.0; z < 3000.0; z += 96.0)
        for (double x = -3000.0; x < 3000.0; x += 96.0) {
            const NodeValue a = node_value(*coarse_land.fields.at(0), x, z);
            const NodeValue f = node_value(*fine_land.fields.at(0), x, z);
            if (a.gain < 0.3) continue;
            sum += std::abs(a.shift - f.shift);
            ++count;
        }
    EXPECT_LT(sum / count, 0.03);
}

TEST(LandCache, TracesOnceAndRenumbers) {
    const TerrainGrid terrain = two_islands();
    const uint64_t hash = terrain_hash(terrain);
    LandCache cache(2);
    WaveTrainBox b = sea_of(20.0, 7000.0, 6000.0);
    const TracedLand first = cache.trace(b, terrain, hash, {5}, LandSettings{});
    expect_equal(first, trace_land(b, terrain, {5}, LandSettings{}));
    // Ids, times and phases do not matter.
    b.id = {99};
    b.begin = {123456};
    b.trains[0].phase = 77;
    const TracedLand again = cache.trace(b, terrain, hash, {40}, LandSettings{});
    EXPECT_EQ(cache.hits(), 1U);
    EXPECT_EQ(cache.misses(), 1U);
    expect_equal(again, trace_land(b, terrain, {40}, LandSettings{}));
    EXPECT_EQ(again.fields.at(0)->blocks().front(), first.fields.at(0)->blocks().front());
}

TEST(LandCache, WhatMattersIsInTheKey) {
    const WaveTrainBox b = sea_of(20.0, 7000.0, 6000.0);
    const LandSettings s;
    const uint64_t key = land_key(b, 1, s);
    EXPECT_NE(key, land_key(b, 2, s));
    WaveTrainBox other = b;
    other.trains[1].amplitude = 0.31F;
    EXPECT_NE(key, land_key(other, 1, s));
    other = b;
    other.width += 1;
    EXPECT_NE(key, land_key(other, 1, s));
    LandSettings changed = s;
    changed.recovery = 1000.0;
    EXPECT_NE(key, land_key(b, 1, changed));
    for (int i = 0; i < 5; ++i) {
        changed = s;
        if (i == 0) changed.run_up = 1.0;
        if (i == 1) changed.shore_decrease = 0.5;
        if (i == 2) changed.shallow_orbits = true;
        if (i == 3) changed.diffraction = Diffraction::none;
        if (i == 4) changed.shoaling = Shoaling::none;
        EXPECT_NE(key, land_key(b, 1, changed)) << i;
    }
    other = b;
    other.trains[1].choppiness = 0.25F;
    EXPECT_EQ(key, land_key(other, 1, s));
    changed = s;
    changed.threads = 5;
    EXPECT_EQ(key, land_key(b, 1, changed));
}

TEST(LandCache, ForgetsTheOldest) {
    const TerrainGrid terrain =
        coast(65, 15, 60, [](double x, double z) { return std::hypot(x, z) < 200.0 ? 5.0 : -60.0; });
    LandCache cache(2);
    WaveTrainBox b = box(0.0, 1500.0, 1500.0);
    b.trains = {train(0.0, 30.0, 0.2)};
    const auto trace_at = [&](double metres) {
        b.origin.x = to_lattice(metres);
        (void)cache.trace(b, terrain, 1, {1}, LandSettings{});
    };
    for (const double x : {-700.0, -600.0, -700.0, -500.0, -700.0, -600.0}) trace_at(x);
    EXPECT_EQ(cache.hits(), 2U);
    EXPECT_EQ(cache.misses(), 4U);
}

}  // namespace
}  // namespace trochoid
