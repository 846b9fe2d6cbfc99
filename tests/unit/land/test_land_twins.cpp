// What server/land does by rows, tiles and vectors, against the slow and obvious: equal to the bit.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "server/land/band_trace.hpp"
#include "server/land/ray_trace.hpp"
#include "server/land/turning.hpp"
#include "tests/unit/land/coasts.hpp"

namespace trochoid {
namespace {

/// Islands, a rough bed, heights in steps of 2^5 lattice units; samples of 2^spacing_log2 lattice units.
TerrainGrid rough_coast(uint32_t samples, uint32_t spacing_log2, double deep = 70.0) {
    return coast(samples, spacing_log2, static_cast<int32_t>(deep), [deep](double x, double z) {
        const double a = (500.0 - std::hypot(x + 700.0, z - 300.0)) / 20.0;
        const double b = (300.0 - std::hypot(x - 900.0, z + 500.0)) / 9.0;
        return std::clamp(std::max(a, b) + 3.0 * std::sin(x / 90.0) * std::cos(z / 70.0), -deep, 30.0);
    });
}

WaveTrainBox sea_of(double heading, double wavelength) {
    WaveTrainBox b = box(heading, 7000.0, 5000.0);
    b.trains = {train(heading, wavelength, wavelength / 120.0), train(heading + 50.0, 31.0, 0.3)};
    return b;
}

TEST(Twins, PlanesAndBlocksTurned) {
    std::mt19937 random(11);
    for (const auto& [nx, nz] : {std::pair{1, 5}, std::pair{33, 49}, std::pair{64, 70}, std::pair{7, 129}}) {
        std::vector<float> plane(static_cast<size_t>(nx * nz));
        for (float& value : plane)
            value = std::bit_cast<float>(static_cast<uint32_t>(random()) & 0x7f7fffffU);
        const std::vector<float> out = turned(plane, static_cast<size_t>(nx), static_cast<size_t>(nz));
        for (int z = 0; z < nz; ++z)
            for (int x = 0; x < nx; ++x)
                ASSERT_EQ(out[static_cast<size_t>(x * nz + z)], plane[static_cast<size_t>(z * nx + x)]);
    }
    constexpr size_t pitch = 23;
    std::vector<int32_t> shifts(pitch * block_nodes);
    std::vector<uint16_t> gains(shifts.size());
    for (size_t i = 0; i < shifts.size(); ++i) {
        shifts[i] = static_cast<int32_t>(random());
        gains[i] = static_cast<uint16_t>(random());
    }
    LandBlock block;
    turn_block(shifts.data(), pitch, block.shift.data());
    turn_block(gains.data(), pitch, block.gain.data());
    for (size_t z = 0; z < block_nodes; ++z)
        for (size_t x = 0; x < block_nodes; ++x) {
            ASSERT_EQ(block.shift[x * block_nodes + z], shifts[z * pitch + x]) << x << " " << z;
            ASSERT_EQ(block.gain[x * block_nodes + z], gains[z * pitch + x]) << x << " " << z;
        }
    EXPECT_EQ(largest_gain(block), *std::max_element(block.gain.begin(), block.gain.end()));
}

TEST(Twins, NodeDepthsOneByOne) {
    for (const uint32_t spacing_log2 : {13U, 15U, 16U})
        for (const double heading : {0.0, 37.0, 90.0, 180.0, 230.0, 270.0}) {
            const TerrainGrid terrain = rough_coast(65, spacing_log2);
            WaveTrainBox b = sea_of(heading, 90.0);
            b.origin.x += 12345;
            LandSettings settings;
            settings.step_log2 = 14;
            const LandArea area = land_area(b, terrain, settings);
            const std::vector<float> depths = node_depths(area, b, terrain, 1.25);
            size_t n = 0;
            size_t behind = 0;
            for (int32_t z = 0; z < area.nodes_z(); ++z)
                for (int32_t x = 0; x < area.nodes_x(); ++x, ++n) {
                    const LatticePoint p = area.at(x, z);
                    const bool rear = (p.x - b.origin.x) * b.ux + (p.z - b.origin.z) * b.uz < 0;
                    behind += rear ? 1U : 0U;
                    ASSERT_EQ(depths[n],
                              rear ? deepest_depth
                                   : static_cast<float>(-height_at(terrain, p.x, p.z)) / 1024.0F + 1.25F)
                        << x << " " << z << " heading " << heading;
                }
            EXPECT_GT(behind, 0U);
        }
}

/// Whole planes, pass after pass.
std::vector<double> slow_phase_depths(const LandArea& area, const std::vector<float>& depths,
                                      const WaveBand& band, const DepthTable& table) {
    const int32_t nx = area.nodes_x();
    const int32_t nz = area.nodes_z();
    std::vector<float> now(depths.size());
    for (size_t n = 0; n < now.size(); ++n)
        now[n] = std::min(std::max(depths[n], table.shallowest()), table.deep());
    const auto smoothed = [&](int32_t dx, int32_t dz) {
        std::vector<float> out(now.size());
        const auto at = [&](int32_t x, int32_t z) {
            return now[static_cast<size_t>(std::clamp(z, 0, nz - 1)) * static_cast<size_t>(nx) +
                       static_cast<size_t>(std::clamp(x, 0, nx - 1))];
        };
        for (int32_t z = 0; z < nz; ++z)
            for (int32_t x = 0; x < nx; ++x) {
                const float here = at(x, z);
                out[static_cast<size_t>(z * nx + x)] =
                    here + 0.25F * ((at(x - dx, z - dz) - here) + (at(x + dx, z + dz) - here));
            }
        return out;
    };
    for (int32_t pass = 0; pass < phase_depth_passes(area, band); ++pass) {
        now = smoothed(1, 0);
        now = smoothed(0, 1);
    }
    return {now.begin(), now.end()};
}

TEST(Twins, PhaseDepthsOfAPart) {
    const TerrainGrid terrain = rough_coast(129, 15);
    for (const double wavelength : {60.0, 400.0, 900.0}) {
        const WaveTrainBox b = sea_of(20.0, wavelength);
        const LandSettings settings;
        const TraceInput in = trace_input(b, terrain, settings, false);
        const WaveBand& band = in.bands.at(0);
        const DepthTable table(response_of(in, band));
        const std::vector<double> slow = slow_phase_depths(in.area, in.depths, band, table);
        PhaseDepths fast(in.area, in.depths, band, table);
        const int32_t nx = in.area.nodes_x();
        const int32_t nz = in.area.nodes_z();
        for (const auto& [rows, columns] :
             {std::pair{NodeRows{0, nz}, IndexRange{0, nx}}, std::pair{NodeRows{16, 32}, IndexRange{32, 48}},
              std::pair{NodeRows{nz - 1, nz}, IndexRange{nx - 1, nx}},
              std::pair{NodeRows{0, 5}, IndexRange{16, nx}}}) {
            fast.take(rows, columns);
            for (int32_t z = rows.from; z < rows.to; ++z)
                for (int32_t x = columns.from; x < columns.to; ++x)
                    ASSERT_EQ(static_cast<double>(*fast.at(x, z)), slow[static_cast<size_t>(z * nx + x)])
                        << x << " " << z << " wave length " << wavelength;
        }
    }
}

/// A point of the grid, and the grid's value there by the written formula.
float slow_sample(const std::vector<float>& plane, int32_t columns, int64_t x, int64_t z) {
    const auto fx = static_cast<float>(static_cast<uint32_t>(x) >> 8) * 0x1p-24F;
    const auto fz = static_cast<float>(static_cast<uint32_t>(z) >> 8) * 0x1p-24F;
    const float* const near = plane.data() + (z >> 32) * columns + (x >> 32);
    const float west = near[0] + (near[columns] - near[0]) * fz;
    const float east = near[1] + (near[columns + 1] - near[1]) * fz;
    return west + (east - west) * fx;
}

TEST(Twins, NodeFieldNodeByNode) {
    const TerrainGrid terrain = rough_coast(257, 15);
    for (const double heading : {1.0, 64.0, -160.0}) {
        const WaveTrainBox b = sea_of(heading, 90.0);
        LandSettings settings;
        settings.run_out = 256.0;
        const TraceInput in = trace_input(b, terrain, settings, false);
        TraceWorkspace work;
        ASSERT_TRUE(trace_band(in, 0, work, nullptr).touched);
        const BandView view = in.view(0);
        const LandArea& area = *view.area;
        const BandGrid& grid = work.grid;
        // Marks are kept for all that is not open water.
        for (size_t n = 0; n < grid.shift.size(); ++n) {
            const auto column = static_cast<int32_t>(n % static_cast<size_t>(grid.columns));
            const auto row = static_cast<int32_t>(n / static_cast<size_t>(grid.columns));
            const uint8_t marks = grid.marks.at(column, row);
            if (grid.shift[n] != 0.0F) {
                ASSERT_NE(marks & BandGrid::shifts, 0);
            }
            if (grid.shelter[n] != 1.0F) {
                ASSERT_NE(marks & BandGrid::shelters, 0);
            }
        }
        const DepthTable table(response_of(in, view.band));
        NodeField field;
        int32_t next = 0;
        fill_node_field(field, area, view.depths, view.tile_depths, view.touching_tiles, grid, table,
                        settings, [&](int32_t bz) { ASSERT_EQ(bz, next++); });
        EXPECT_EQ(next, area.blocks_z);
        size_t compared = 0;
        for (int32_t z = 0; z < area.nodes_z(); ++z)
            for (int32_t x = 0; x < area.nodes_x(); ++x) {
                const auto n = static_cast<size_t>(z * area.nodes_x() + x);
                const int64_t gx = to_q32(grid.column_of(0.0, z)) + x * to_q32(-grid.dz);
                const int64_t gz = to_q32(grid.row_of(0.0, z) - grid.first_row) + x * to_q32(grid.dx);
                if (view.touching_tiles[static_cast<size_t>((z / 16) * ((area.nodes_x() - 1) / 16 + 1) +
                                                            x / 16)] == 0)
                    continue;
                if (gx < 0 || gz < 0 || gx >= int64_t{grid.columns - 1} << 32 ||
                    gz >= int64_t{grid.rows - grid.first_row - 1} << 32) {
                    ASSERT_EQ(field.shift[n], 0);
                    ASSERT_EQ(field.gain[n], unit_node_gain);
                    continue;
                }
                const double step = area.step();
                if (x * step < area.belt_min_x || x * step > area.belt_max_x || z * step < area.belt_min_z ||
                    z * step > area.belt_max_z)
                    continue;
                const float turns = slow_sample(grid.shift, grid.columns, gx, gz) * 65536.0F;
                const float half = turns < 0.0F ? -0.5F : 0.5F;
                const auto shift = static_cast<int32_t>(turns + half);
                ASSERT_EQ(field.shift[n], std::abs(shift) < 64 ? 0 : shift) << x << " " << z;
                const float depth = view.depths[n];
                const float growth =
                    depth >= table.untouched() ? 1.0F : (depth > 0.0F ? table.at(depth) : table.land())[1];
                float gain = slow_sample(grid.shelter, grid.columns, gx, gz) * growth;
                if (depth < table.breaking()) gain = std::min(gain, depth > 0.0F ? table.at(depth)[2] : 0.0F);
                const float raised = std::min(gain * 32768.0F, 65535.0F) + 0.5F;
                const auto value = static_cast<int32_t>(raised);
                ASSERT_EQ(field.gain[n], std::abs(value - 32768) <= 16 ? 32768 : value) << x << " " << z;
                compared += shift != 0 ? 1U : 0U;
            }
        EXPECT_GT(compared, 1000U);
    }
}

/// Walks every half node.
std::vector<ActionPoint> slow_points(const WaveRay& ray, const WaveTrainBox& b, double v, double u_from,
                                     double u_to, const TerrainGrid& terrain, const DepthResponse& response,
                                     double felt_depth, const LandSettings& settings) {
    std::vector<ActionPoint> points;
    const double ux = static_cast<double>(b.ux) * 0x1p-30;
    const double uz = static_cast<double>(b.uz) * 0x1p-30;
    const auto nearest = [](double at) { return static_cast<int64_t>(at < 0.0 ? at - 0.5 : at + 0.5); };
    const double step = static_cast<double>(int64_t{1} << settings.step_log2) * 0.5;
    double share = 1.0;
    bool felt = false;
    bool land = false;
    bool recovering = false;
    for (double u = u_from; u <= u_to; u += step) {
        const LatticePoint at{nearest(static_cast<double>(b.origin.x) + u * ux - v * uz),
                              nearest(static_cast<double>(b.origin.z) + u * uz + v * ux)};
        const double depth = to_metres(-int64_t{height_at(terrain, at.x, at.z)}) + settings.run_up;
        if (depth < felt_depth && !felt) points.push_back({at, ActionKind::shoaling_starts});
        felt = depth < felt_depth || (felt && depth < 1.25 * felt_depth);
        if ((depth <= 0.0) != land)
            points.push_back({at, land ? ActionKind::water_again : ActionKind::blocked});
        land = depth <= 0.0;
        share =
            std::min(std::min(share + step / 1024.0 / settings.recovery, 1.0), response.share_limit(depth));
        recovering = recovering || land;
        if (recovering && share >= 1.0) points.push_back({at, ActionKind::recovered});
        recovering = recovering && share < 1.0;
    }
    EXPECT_EQ(ray.start.x, nearest(static_cast<double>(b.origin.x) - v * uz));
    return points;
}

TEST(Twins, RaysStepByStep) {
    for (const double deep : {70.0, 28.0})
        for (const double wavelength : {150.0, 60.0, 24.0}) {
            const TerrainGrid terrain = rough_coast(513, 15, deep);
            LandSettings settings;
            settings.run_up = 0.5;
            const WaveTrainBox b = sea_of(20.0, wavelength);
            const TraceInput in = trace_input(b, terrain, settings, false);
            const WaveBand& band = in.bands.at(0);
            const DepthResponse response = response_of(in, band);
            const std::vector<WaveRay> rays = wave_rays(b, terrain, band, settings);
            size_t points = 0;
            for (size_t i = 0; i < rays.size(); ++i) {
                const double v = static_cast<double>(b.width) * (2.0 * static_cast<double>(i) + 1.0) /
                                 (2.0 * static_cast<double>(rays.size()));
                const std::vector<ActionPoint> slow =
                    slow_points(rays[i], b, v, 0.0, static_cast<double>(b.length), terrain, response,
                                std::min(0.5 / band.turns_per_metre, response.deep()), settings);
                ASSERT_EQ(rays[i].points, slow) << "ray " << i << " wave length " << wavelength;
                points += slow.size();
            }
            EXPECT_GT(points, 100U);
        }
}

}  // namespace
}  // namespace trochoid
