#include "server/import/coast_import.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "protocol/units/hash.hpp"
#include "protocol/units/lattice.hpp"
#include "server/import/shore_distance.hpp"
#include "server/import/terrain_path.hpp"
#include "tests/unit/import/geotiff_writer.hpp"

namespace trochoid {
namespace {

double unit_random(uint64_t& state) { return static_cast<double>(splitmix64(++state) >> 11) * 0x1p-53; }

/// Star-shaped rings at random places; they overlap, so that some samples lie inside two (sea again).
std::vector<ShoreRing> random_rings(uint64_t seed) {
    std::vector<ShoreRing> rings;
    for (int ring = 0; ring < 9; ++ring) {
        const EastNorth centre{(unit_random(seed) - 0.5) * 2600.0, (unit_random(seed) - 0.5) * 2600.0};
        const int corners = 3 + static_cast<int>(unit_random(seed) * 40.0);
        ShoreRing points;
        for (int i = 0; i < corners; ++i) {
            const double angle = 6.283185307 * i / corners;
            const double radius = 30.0 + 400.0 * unit_random(seed);
            points.push_back(
                {centre.east + radius * std::cos(angle), centre.north + radius * std::sin(angle)});
        }
        rings.push_back(points);
    }
    return rings;
}

TerrainGrid empty_grid(uint32_t columns, uint32_t rows) {
    TerrainGrid grid;
    grid.spacing_log2 = 14;
    grid.columns = columns;
    grid.rows = rows;
    grid.origin_x = -int64_t{columns / 2} << 14;
    grid.origin_z = -int64_t{rows / 2} << 14;
    return grid;
}

/// Even-odd rule by casting a ray eastwards from one point, over all sides.
bool slow_inside(const std::vector<ShoreRing>& rings, EastNorth p) {
    bool inside = false;
    for (const ShoreRing& ring : rings) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const EastNorth a = ring[i];
            const EastNorth b = ring[(i + 1) % ring.size()];
            if ((a.north >= p.north) == (b.north >= p.north)) continue;
            if (p.east >= a.east + (p.north - a.north) * (b.east - a.east) / (b.north - a.north))
                inside = !inside;
        }
    }
    return inside;
}

double slow_distance(const std::vector<ShoreRing>& rings, EastNorth p) {
    double best = std::numeric_limits<double>::infinity();
    for (const ShoreRing& ring : rings) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const EastNorth a = ring[i];
            const EastNorth b = ring[(i + 1) % ring.size()];
            // The nearest point of a side: one of its ends, or the foot of the perpendicular where that lies between.
            best = std::min({best, std::hypot(p.east - a.east, p.north - a.north),
                             std::hypot(p.east - b.east, p.north - b.north)});
            const double east = b.east - a.east, north = b.north - a.north;
            const double along = (p.east - a.east) * east + (p.north - a.north) * north;
            if (along > 0.0 && along < east * east + north * north)
                best = std::min(best, std::fabs((p.east - a.east) * north - (p.north - a.north) * east) /
                                          std::hypot(east, north));
        }
    }
    return best;
}

TEST(LandMask, EqualsRayCastingAtEverySample) {
    for (uint64_t seed = 1; seed < 6; ++seed) {
        const std::vector<ShoreRing> rings = random_rings(seed * 1000);
        const TerrainGrid grid = empty_grid(97, 141);
        const LandMask mask = land_mask(grid, rings);
        std::size_t land = 0;
        for (int64_t row = 0; row < 141; ++row) {
            for (int64_t column = 0; column < 97; ++column) {
                const EastNorth at{double(column - 48) * 16.0, -double(row - 70) * 16.0};
                const bool is_land = mask.land[static_cast<std::size_t>(row * 97 + column)] != 0;
                ASSERT_EQ(is_land, slow_inside(rings, at)) << seed << ": " << at.east << ',' << at.north;
                land += is_land;
            }
        }
        EXPECT_GT(land, 500U);
    }
}

TEST(LandMask, SidesThroughSamplesCountOnce) {
    // Corners and sides exactly on samples: the west and north sides belong to the square, the others do not.
    const TerrainGrid grid = empty_grid(9, 9);
    const ShoreRing square{{-32, -32}, {32, -32}, {32, 32}, {-32, 32}};
    for (const bool turned : {false, true}) {
        const ShoreRing ring = turned ? ShoreRing(square.rbegin(), square.rend()) : square;
        const LandMask mask = land_mask(grid, {ring});
        for (int row = 0; row < 9; ++row)
            for (int column = 0; column < 9; ++column)
                EXPECT_EQ(mask.land[static_cast<std::size_t>(row * 9 + column)],
                          row >= 2 && row < 6 && column >= 2 && column < 6);
    }
}

TEST(LandMask, RocksBetweenSamplesAreCounted) {
    const TerrainGrid grid = empty_grid(9, 9);
    EXPECT_EQ(
        land_mask(grid, {{{3, 3}, {9, 3}, {6, 9}}, {{-20, -20}, {20, -20}, {0, 20}}}).rings_without_sample,
        1U);
    EXPECT_EQ(land_mask(grid, {{{5003, 3}, {5009, 3}, {5006, 9}}}).rings_without_sample, 0U);
}

TEST(ShoreDistance, EqualsBruteForce) {
    for (uint64_t seed = 1; seed < 4; ++seed) {
        const std::vector<ShoreRing> rings = random_rings(seed * 77);
        const ShoreDistance shore(rings);
        uint64_t state = seed;
        for (int i = 0; i < 3000; ++i) {
            const double reach = i % 3 == 0 ? 60'000.0 : 3000.0;
            const EastNorth at{(unit_random(state) - 0.5) * reach, (unit_random(state) - 0.5) * reach};
            ASSERT_NEAR(shore.at(at), slow_distance(rings, at), 1e-7) << at.east << ',' << at.north;
        }
        for (const ShoreRing& ring : rings) EXPECT_EQ(shore.at(ring[1]), 0.0);
    }
    EXPECT_TRUE(std::isinf(ShoreDistance({}).at({0, 0})));
}

TEST(CoastProfile, DeanClosedFormAndSmoothCap) {
    // Dean's own figure: A = 0.1 m^(1/3), 1000 m offshore, is 10 m deep; 125 m is 2.5 m.
    EXPECT_NEAR(dean_depth(0.1, 1000.0), 10.0, 1e-12);
    EXPECT_NEAR(dean_depth(0.1, 125.0), 2.5, 1e-12);
    EXPECT_EQ(dean_depth(0.1, 0.0), 0.0);
    EXPECT_EQ(capped_depth(29.9, 60.0), 29.9);
    EXPECT_EQ(capped_depth(90.0, 60.0), 60.0);
    EXPECT_EQ(capped_depth(1e9, 60.0), 60.0);
    double before = 0.0;
    for (double depth = 0.01; depth < 120.0; depth += 0.01) {
        const double capped = capped_depth(depth, 60.0);
        EXPECT_GE(capped, before);
        EXPECT_LE(capped - before, 0.01 + 1e-9);
        EXPECT_LE(capped, std::min(depth, 60.0) + 1e-9);
        before = capped;
    }
}

TEST(CoastProfile, LandStaysAboveTheSeaAndBelowItsTop) {
    const LandShape shape{30.0, 0.2, 7};
    uint64_t state = 0;
    for (int i = 0; i < 5000; ++i) {
        const double inland = 0.1 + 4000.0 * unit_random(state);
        const EastNorth at{1e4 * (unit_random(state) - 0.5), 1e4 * (unit_random(state) - 0.5)};
        const double height = synthetic_land_height(shape, inland, at);
        EXPECT_GT(height, 0.0);
        EXPECT_LE(height, 30.0);
        EXPECT_EQ(height, synthetic_land_height(shape, inland, at));
        const double beside = synthetic_land_height(shape, inland, {at.east + 0.01, at.north});
        EXPECT_NEAR(beside, height, 0.01) << "noise jumps at " << at.east << ',' << at.north;
    }
}

class CoastImport : public testing::Test {
protected:
    std::filesystem::path shore(const std::string& text) {
        std::ofstream(folder_ / "shore.geojson") << text;
        return folder_ / "shore.geojson";
    }
    static CoastRequest request_at(LonLat origin, double side = 8192.0) {
        CoastRequest request;
        request.grid.origin = origin;
        request.grid.width = request.grid.height = side;
        request.source = "test";
        return request;
    }
    std::string refusal(const std::string& text) {
        const auto path = shore(text);
        return operator_error_of([&] { import_coast(path, request_at({0, 0})); });
    }
    ScratchFolder folder_;
};

TEST_F(CoastImport, StraightCoastFollowsTheProfile) {
    // Land west of the meridian; on eqc at the equator the shore is the line x = 0, far ends at 55 km.
    CoastRequest request = request_at({0, 0});
    request.grid.projection = "eqc";
    request.max_depth = 40.0;
    const auto path =
        shore(R"({"type":"Polygon","coordinates":[[[0,-0.5],[0,0.5],[-1,0.5],[-1,-0.5],[0,-0.5]]]})");
    const TerrainGrid grid = import_coast(path, request).grid;
    ASSERT_EQ(terrain_fault(grid), nullptr);
    for (int64_t column = 0; column < grid.columns; ++column) {
        const double east = double(column - 128) * 32.0;
        for (const int64_t row : {0, 100, 256}) {
            const double metres = grid.heights[static_cast<std::size_t>(row * grid.columns + column)] / 32.0;
            if (east < 0.0) {
                EXPECT_GE(metres, 1.0 / 32);
                EXPECT_LE(metres, 45.0);
            } else if (0.1 * std::pow(east, 2.0 / 3.0) <= 20.0) {
                // The sample on the line itself is sea and lies one count below.
                EXPECT_NEAR(metres, std::min(-1.0 / 32, -0.1 * std::pow(east, 2.0 / 3.0)), 0.5 / 32 + 1e-6)
                    << east;
            } else {
                EXPECT_LT(metres, -20.0 + 0.04);
                EXPECT_GE(metres, -40.0);
            }
        }
    }
    EXPECT_EQ(grid.open_sea_depth, -40 * 1024);
    EXPECT_NE(grid.provenance.find("synthetic"), std::string::npos);
    EXPECT_EQ(import_coast(path, request).grid, grid);
}

TEST_F(CoastImport, HolesAreLakesAndAllGeoJsonFormsAgree) {
    const std::string outer = "[[-0.02,-0.02],[0.02,-0.02],[0.02,0.02],[-0.02,0.02],[-0.02,-0.02]]";
    const std::string hole = "[[-0.01,-0.01],[-0.01,0.01],[0.01,0.01],[0.01,-0.01],[-0.01,-0.01]]";
    const auto filled = [&](std::string form) {
        for (const auto& [mark, ring] : {std::pair{'O', outer}, std::pair{'H', hole}})
            for (std::size_t at = form.find(mark); at != std::string::npos; at = form.find(mark))
                form.replace(at, 1, ring);
        return shore(form);
    };
    const TerrainGrid grid =
        import_coast(filled(R"({"type":"Polygon","coordinates":[O,H]})"), request_at({0, 0})).grid;
    EXPECT_LT(height_at(grid, 0, 0), 0);
    EXPECT_GT(height_at(grid, 1700 * 1024, 0), 0);
    EXPECT_LT(height_at(grid, 3000 * 1024, 0), 0);
    // O and H stand for the rings.
    for (const char* form : {
             R"({"type":"MultiPolygon","coordinates":[[O,H]]})",
             R"({"type":"MultiLineString","coordinates":[O,H]})",
             R"({"type":"GeometryCollection","geometries":[{"type":"LineString","coordinates":O},
                {"type":"LineString","coordinates":H}]})",
             R"({"type":"FeatureCollection","features":[
                {"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[O,H]}},
                {"type":"Feature","properties":{},"geometry":null}]})",
         })
        EXPECT_EQ(import_coast(filled(form), request_at({0, 0})).grid, grid) << form;
}

TEST_F(CoastImport, RingsAcrossTheDateLineInAnyTurn) {
    const auto ring = [](double west, double east) {
        return fmt::format(
            R"({{"type":"Polygon","coordinates":[[[{0},-0.01],[{1},-0.01],[{1},0.01],[{0},0.01],[{0},-0.01]]]}})",
            west, east);
    };
    const TerrainGrid plain = import_coast(shore(ring(179.99, 180.02)), request_at({180.0, 0})).grid;
    EXPECT_GT(height_at(plain, 2000 * 1024, 0), 0);
    EXPECT_LT(height_at(plain, -2000 * 1024, 0), 0);
    const TerrainGrid torn = import_coast(shore(ring(179.99, -179.98)), request_at({-180.0, 0})).grid;
    for (std::size_t i = 0; i < plain.heights.size(); ++i) ASSERT_NEAR(plain.heights[i], torn.heights[i], 1);
}

TEST_F(CoastImport, BadShoreLinesAreRefused) {
    const auto says = [](const std::string& text, const char* part) {
        return text.find(part) != std::string::npos;
    };
    EXPECT_TRUE(says(refusal("nonsense"), "no GeoJSON"));
    EXPECT_TRUE(says(refusal("{}"), "no GeoJSON"));
    EXPECT_TRUE(says(refusal("[1,2]"), "no GeoJSON"));
    EXPECT_TRUE(says(refusal(R"({"type":"Point","coordinates":[0,0]})"), "no shore line"));
    EXPECT_TRUE(says(refusal(R"({"type":"FeatureCollection","features":[]})"), "holds no shore line"));
    EXPECT_TRUE(
        says(refusal(R"({"type":"LineString","coordinates":[[0,0],[1,0],[1,1],[0,1]]})"), "not closed"));
    EXPECT_TRUE(
        says(refusal(R"({"type":"Polygon","coordinates":[[[0,0],[1,"a"],[1,1],[0,0]]]})"), "no GeoJSON"));
    EXPECT_TRUE(says(refusal(R"({"type":"Polygon","coordinates":[[[0,0],[1],[1,1],[0,0]]]})"), "no GeoJSON"));
    EXPECT_TRUE(says(refusal(R"({"type":"Polygon","coordinates":[[[0,0],[1,100],[1,1],[0,0]]]})"),
                     "crop the shore line"));
    EXPECT_TRUE(says(operator_error_of([&] {
                         import_coast(folder_ / "absent", request_at({0, 0}));
                     }),
                     "check the path"));
    CoastRequest request = request_at({0, 0});
    request.dean_a = 0.0;
    EXPECT_TRUE(says(operator_error_of([&] { import_coast(folder_ / "absent", request); }), "--dean-a"));
}

TEST(TerrainPath, RoundTripAndRefusals) {
    const ScratchFolder folder;
    TerrainGrid grid;
    grid.columns = grid.rows = 3;
    grid.heights = {1, 2, 3, 4, -5, 6, 7, 8, 9};
    write_terrain(folder / "a.terrain", grid);
    EXPECT_EQ(read_terrain(folder / "a.terrain"), grid);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.terrain.partial"));
    std::filesystem::resize_file(folder / "a.terrain", 50);
    const std::string torn = operator_error_of([&] { read_terrain(folder / "a.terrain"); });
    EXPECT_NE(torn.find("a.terrain: the terrain is cut short"), std::string::npos) << torn;
    EXPECT_NE(operator_error_of([&] { read_terrain(folder / "b.terrain"); }).find("b.terrain"),
              std::string::npos);
    EXPECT_NE(operator_error_of([&] { read_terrain(folder / "."); }), "");
    EXPECT_NE(
        operator_error_of([&] { write_terrain(folder / "none/a.terrain", grid); }).find("folder exists"),
        std::string::npos);
}

}  // namespace
}  // namespace trochoid
