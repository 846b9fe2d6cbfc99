#include "server/import/raster_import.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "protocol/units/lattice.hpp"
#include "server/import/map_projection.hpp"
#include "tests/unit/import/geotiff_writer.hpp"

namespace trochoid {
namespace {

using Type = GeotiffSpec::Type;
using Georeference = GeotiffSpec::Georeference;

constexpr LonLat place{2.5, 43.0};

/// Linear, so that bilinear sampling of it is exact: rises to the east by 900 m and to the north by 500 m a degree.
double slope(double lon, double lat) { return 900.0 * (lon - place.lon) + 500.0 * (lat - place.lat); }

/// 0.01 degrees apart around `place`, north-up, pixels are areas.
GeotiffSpec around_place() {
    GeotiffSpec spec;
    spec.columns = 60;
    spec.rows = 50;
    spec.first_x = 2.205;
    spec.first_y = 43.245;
    spec.step_x = 0.01;
    spec.step_y = -0.01;
    spec.height = slope;
    return spec;
}

RasterRequest request_at(LonLat origin, double side = 16'384.0, double spacing = 512.0) {
    RasterRequest request;
    request.grid.origin = origin;
    request.grid.width = request.grid.height = side;
    request.grid.spacing = spacing;
    return request;
}

/// Largest difference, metres, between the imported grid and a height field over longitude and latitude.
double largest_error(const TerrainGrid& grid, LonLat origin,
                     const std::function<double(double, double)>& height,
                     const std::string& projection = "tmerc") {
    const WorldMap map(projection, origin);
    double worst = 0.0;
    for (uint32_t row = 0; row < grid.rows; ++row) {
        for (uint32_t column = 0; column < grid.columns; ++column) {
            const double east = to_metres(grid.origin_x + (int64_t{column} << grid.spacing_log2));
            const double south = to_metres(grid.origin_z + (int64_t{row} << grid.spacing_log2));
            const LonLat at = map.to_lon_lat({east, -south});
            const double metres =
                std::ldexp(double(grid.heights[row * grid.columns + column]), grid.height_step_log2 - 10);
            worst = std::max(worst, std::fabs(metres - height(at.lon, at.lat)));
        }
    }
    return worst;
}

class RasterImport : public testing::Test {
protected:
    ImportedTerrain import(const GeotiffSpec& spec, const RasterRequest& request = request_at(place)) {
        write_geotiff(folder_ / "in.tif", spec);
        return import_raster(folder_ / "in.tif", request);
    }
    std::string refusal(const GeotiffSpec& spec, const RasterRequest& request = request_at(place)) {
        return operator_error_of([&] { import(spec, request); });
    }
    /// Half a count, and what floats lose.
    static constexpr double rounding = 0.5 / 32 + 1e-4;
    ScratchFolder folder_;
};

TEST_F(RasterImport, EastIsEastAndSouthIsDownTheRows) {
    const TerrainGrid grid = import(around_place()).grid;
    EXPECT_EQ(grid.columns, 33U);
    EXPECT_EQ(grid.rows, 33U);
    EXPECT_EQ(grid.origin_x, -16 * 512 * 1024);
    EXPECT_EQ(terrain_fault(grid), nullptr);
    EXPECT_GT(grid.heights[32], grid.heights[0]);       // rises eastwards
    EXPECT_GT(grid.heights[0], grid.heights[32 * 33]);  // falls southwards
    EXPECT_NEAR(height_at(grid, 0, 0), 0, 33);          // the origin is where it was asked for
    EXPECT_LT(largest_error(grid, place, slope), rounding);
}

TEST_F(RasterImport, EveryProjectionPutsHeightsWhereItsOwnMapSays) {
    for (const char* projection :
         {"tmerc", "laea", "eqc", "stere", "utm", "+proj=lcc +lat_1=42 +lat_2=44 +lon_0=3 +ellps=WGS84"}) {
        RasterRequest request = request_at(place);
        request.grid.projection = projection;
        const TerrainGrid grid = import(around_place(), request).grid;
        EXPECT_LT(largest_error(grid, place, slope, projection), rounding) << projection;
        EXPECT_EQ(grid.projection.substr(0, 6), "+proj=");
    }
}

TEST_F(RasterImport, PixelsAsPointsSitOnTheirCoordinates) {
    GeotiffSpec spec = around_place();
    spec.pixel_is_point = true;
    EXPECT_LT(largest_error(import(spec).grid, place, slope), rounding);
}

TEST_F(RasterImport, RowsFromSouthToNorth) {
    for (const Georeference georeference : {Georeference::scale, Georeference::matrix}) {
        GeotiffSpec spec = around_place();
        spec.first_y = 42.755;
        spec.step_y = 0.01;
        spec.georeference = georeference;
        EXPECT_LT(largest_error(import(spec).grid, place, slope), rounding);
    }
}

TEST_F(RasterImport, EverySampleTypeLayoutAndByteOrder) {
    for (const Type type : {Type::int16, Type::int32, Type::float32, Type::float64}) {
        for (int variant = 0; variant < 8; ++variant) {
            GeotiffSpec spec = around_place();
            spec.type = type;
            spec.tiled = (variant & 1) != 0;
            spec.deflate = (variant & 2) != 0;
            spec.big_endian = (variant & 4) != 0;
            const double whole_metres = type == Type::int16 || type == Type::int32 ? 0.5 : 0.0;
            EXPECT_LT(largest_error(import(spec).grid, place, slope), rounding + whole_metres)
                << int(type) << " variant " << variant;
        }
    }
}

TEST_F(RasterImport, UnsignedDepths) {
    for (const Type type : {Type::uint8, Type::uint16}) {
        GeotiffSpec spec = around_place();
        spec.type = type;
        const auto depth = [](double lon, double lat) { return 120.0 + 0.2 * slope(lon, lat); };
        spec.height = depth;
        RasterRequest request = request_at(place);
        request.sign = RasterSign::down;
        EXPECT_LT(largest_error(import(spec, request).grid, place,
                                [&](double lon, double lat) { return -depth(lon, lat); }),
                  rounding + 0.5);
    }
}

TEST_F(RasterImport, PositiveDownByOptionByDescriptionAndByVerticalDatum) {
    GeotiffSpec spec = around_place();
    spec.height = [](double lon, double lat) { return -slope(lon, lat); };
    RasterRequest request = request_at(place);
    request.sign = RasterSign::down;
    EXPECT_LT(largest_error(import(spec, request).grid, place, slope), rounding);

    GeotiffSpec described = spec;
    described.description = "units=m positive=DOWN";
    EXPECT_LT(largest_error(import(described).grid, place, slope), rounding);

    GeotiffSpec named = spec;
    named.description = "Depth below chart datum";
    EXPECT_LT(largest_error(import(named).grid, place, slope), rounding);

    GeotiffSpec datum = spec;
    datum.vertical_epsg = 5715;
    EXPECT_LT(largest_error(import(datum).grid, place, slope), rounding);

    // The operator's word beats the file's.
    RasterRequest up = request_at(place);
    up.sign = RasterSign::up;
    EXPECT_LT(largest_error(import(described, up).grid, place, spec.height), rounding);
}

TEST_F(RasterImport, AllPositiveValuesWithoutAWordAreRefused) {
    GeotiffSpec spec = around_place();
    spec.height = [](double, double) { return 30.0; };
    EXPECT_NE(refusal(spec).find("--positive down or --positive up"), std::string::npos);
    spec.description = "elevation in metres";
    EXPECT_EQ(refusal(spec), "");
}

TEST_F(RasterImport, RegionalLongitudesOnAnotherTurn) {
    GeotiffSpec spec = around_place();
    spec.first_x += 360.0;
    spec.height = [](double lon, double lat) { return slope(lon - 360.0, lat); };
    EXPECT_LT(largest_error(import(spec).grid, place, slope), rounding);
    // And an origin on another turn than the raster.
    EXPECT_LT(
        largest_error(import(around_place(), request_at({place.lon - 360.0, place.lat})).grid, place, slope),
        rounding);
}

/// A raster around the globe, a degree a sample, heights linear in longitude near `centre`.
GeotiffSpec around_the_globe(double first_lon, double centre, bool repeats_first_column) {
    GeotiffSpec spec;
    spec.columns = repeats_first_column ? 361 : 360;
    spec.rows = 180;
    spec.first_x = first_lon;
    spec.first_y = 89.5;
    spec.step_x = 1.0;
    spec.step_y = -1.0;
    spec.pixel_is_point = repeats_first_column;
    spec.height = [centre](double lon, double lat) { return 10.0 * wrap_degrees(lon - centre) + lat; };
    return spec;
}

TEST_F(RasterImport, AcrossTheSeamOfAGlobalRaster) {
    struct Case {
        double first_lon, origin_lon;
        bool repeats;
    };
    for (const Case& c : {Case{0.5, 0.1, false}, Case{0.5, -0.3, false}, Case{0.5, 359.9, false},
                          Case{-179.5, 179.8, false}, Case{-179.5, -179.9, false}, Case{0.0, 0.0, true},
                          Case{-180.0, 180.0, true}, Case{0.5, 200.0, false}, Case{-179.5, 200.0, false}}) {
        const LonLat origin{c.origin_lon, 12.0};
        const auto field = [&](double lon, double lat) {
            return 10.0 * wrap_degrees(lon - origin.lon) + lat;
        };
        GeotiffSpec spec = around_the_globe(c.first_lon, origin.lon, c.repeats);
        const RasterRequest request = request_at(origin, 262'144.0, 1024.0);
        RasterRequest signed_request = request;
        signed_request.sign = RasterSign::up;
        EXPECT_LT(largest_error(import(spec, signed_request).grid, origin, field), rounding)
            << "first longitude " << c.first_lon << ", origin " << c.origin_lon;
    }
}

TEST_F(RasterImport, ProjectedRasterThroughItsOwnSystem) {
    const ProjConversion utm("+proj=utm +zone=31 +datum=WGS84 +units=m");
    const EastNorth centre = utm.forward(place);
    GeotiffSpec spec;
    spec.columns = spec.rows = 60;
    spec.step_x = 400.0;
    spec.step_y = -400.0;
    spec.first_x = centre.east - 30 * 400.0;
    spec.first_y = centre.north + 30 * 400.0;
    spec.projected_epsg = 32631;
    const auto height = [&](double x, double y) {
        return 0.01 * (x - centre.east) - 0.02 * (y - centre.north);
    };
    spec.height = height;
    const auto over_places = [&](double lon, double lat) {
        const EastNorth at = utm.forward({lon, lat});
        return height(at.east, at.north);
    };
    EXPECT_LT(largest_error(import(spec).grid, place, over_places), rounding);
    EXPECT_NE(refusal(spec, request_at({2.5, 43.3})).find("latitude 42.89"), std::string::npos);
}

TEST_F(RasterImport, MissingSamplesAreFilledAndCounted) {
    const auto hole = [](double lon, double lat) {
        return std::fabs(lon - 2.5) < 0.016 && std::fabs(lat - 43.0) < 0.016;
    };
    struct Case {
        Type type;
        double marker;
        std::string tag;
        std::optional<double> option;
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Case& c : {Case{Type::int16, -9999, "-9999", {}}, Case{Type::float32, -9999, "", -9999.0},
                          Case{Type::float32, nan, "", {}}, Case{Type::float32, nan, "nan", {}},
                          Case{Type::float32, -3.4028234663852886e38, "-3.4028235e+38", {}},
                          Case{Type::float64, -1e300, "-1e300", {}}, Case{Type::float32, 0.1, "0.1", {}}}) {
        GeotiffSpec spec = around_place();
        spec.type = c.type;
        spec.nodata = c.tag;
        spec.height = [&](double lon, double lat) { return hole(lon, lat) ? c.marker : slope(lon, lat); };
        RasterRequest request = request_at(place);
        request.nodata = c.option;
        const ImportedTerrain imported = import(spec, request);
        const auto& notes = imported.report.notes;
        // Samples' centres at 2.495, 2.505 and beyond: 4 x 4 of them in the hole less rounding at its rim.
        EXPECT_TRUE(std::any_of(
            notes.begin(), notes.end(),
            [](const std::string& n) { return n.find("16 missing samples") != std::string::npos; }))
            << testing::PrintToString(notes) << ' ' << c.tag;
        // Filling a hole of 4 samples from its rim: within a couple of sample steps of the slope.
        EXPECT_LT(largest_error(imported.grid, place, slope), 2.5 * 14.0) << c.tag;
    }
}

TEST_F(RasterImport, MostlyMissingIsRefused) {
    GeotiffSpec spec = around_place();
    spec.nodata = "-9999";
    spec.height = [](double lon, double lat) { return lon > 2.48 ? -9999.0 : slope(lon, lat); };
    EXPECT_NE(refusal(spec).find("more than half"), std::string::npos);
}

TEST_F(RasterImport, AnUndeclaredMarkerIsRefusedByItsValue) {
    GeotiffSpec spec = around_place();
    spec.height = [](double lon, double lat) { return lon > 2.55 ? -32'768.0 : slope(lon, lat); };
    EXPECT_NE(refusal(spec).find("give it as --nodata"), std::string::npos);
    spec.height = [](double, double) { return std::numeric_limits<double>::infinity(); };
    RasterRequest up = request_at(place);
    up.sign = RasterSign::up;
    EXPECT_NE(refusal(spec, up).find("--nodata"), std::string::npos);
}

TEST_F(RasterImport, AreaBeyondTheRasterNamesItsBounds) {
    const std::string message = refusal(around_place(), request_at({2.75, 43.0}));
    EXPECT_NE(message.find("longitude 2.2 to 2.8, latitude 42.75 to 43.25"), std::string::npos) << message;
    EXPECT_NE(message.find('%'), std::string::npos);
    EXPECT_NE(refusal(around_place(), request_at({-100.0, 43.0})).find("100 %"), std::string::npos);
}

TEST_F(RasterImport, FilesThatAreNoHeightRastersAreRefused) {
    const auto message = [&](auto change) {
        GeotiffSpec spec = around_place();
        change(spec);
        return refusal(spec);
    };
    const auto says = [](const std::string& text, const char* part) {
        return text.find(part) != std::string::npos;
    };
    EXPECT_TRUE(
        says(message([](GeotiffSpec& s) { s.georeference = Georeference::none; }), "no georeference"));
    EXPECT_TRUE(says(message([](GeotiffSpec& s) { s.georeference = Georeference::no_system; }),
                     "no coordinate system"));
    EXPECT_TRUE(says(message([](GeotiffSpec& s) { s.georeference = Georeference::control_points; }),
                     "control points"));
    EXPECT_TRUE(says(message([](GeotiffSpec& s) { s.bands = 3; }), "3 bands"));
    EXPECT_TRUE(says(message([](GeotiffSpec& s) { s.type = Type::int64; }), "no heights"));
    EXPECT_TRUE(says(message([](GeotiffSpec& s) { s.step_x = 0.0; }), "no georeference"));
    EXPECT_TRUE(says(operator_error_of([&] { import_raster(folder_ / "absent.tif", request_at(place)); }),
                     "absent.tif"));
    std::ofstream(folder_ / "text.tif") << "not a raster";
    EXPECT_TRUE(
        says(operator_error_of([&] { import_raster(folder_ / "text.tif", request_at(place)); }), "no TIFF"));
}

TEST_F(RasterImport, TornFilesGiveOneMessageAndNeverCrash) {
    GeotiffSpec spec = around_place();
    spec.deflate = true;
    write_geotiff(folder_ / "whole.tif", spec);
    std::ifstream whole(folder_ / "whole.tif", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(whole)), {});
    for (std::size_t length = 0; length < bytes.size(); length += 97) {
        std::ofstream(folder_ / "torn.tif", std::ios::binary) << bytes.substr(0, length);
        EXPECT_NE(operator_error_of([&] { import_raster(folder_ / "torn.tif", request_at(place)); }), "")
            << length;
    }
}

TEST_F(RasterImport, AbsurdGridsAreRefused) {
    const auto message = [&](auto change) {
        RasterRequest request = request_at(place);
        change(request);
        return refusal(around_place(), request);
    };
    const auto says = [](const std::string& text, const char* part) {
        return text.find(part) != std::string::npos;
    };
    EXPECT_TRUE(says(message([](RasterRequest& r) { r.grid.spacing = 30.0; }), "power of two"));
    EXPECT_TRUE(says(message([](RasterRequest& r) { r.grid.spacing = std::nan(""); }), "power of two"));
    EXPECT_TRUE(says(message([](RasterRequest& r) { r.grid.width = 1e9; }), "16,384"));
    EXPECT_TRUE(says(message([](RasterRequest& r) { r.grid.height = -5.0; }), "smaller than its spacing"));
    EXPECT_TRUE(
        says(message([](RasterRequest& r) { r.grid.projection = "mercatorr"; }), "unknown projection"));
    EXPECT_TRUE(
        says(message([](RasterRequest& r) { r.grid.projection = "+proj=nonsense"; }), "unknown projection"));
    EXPECT_TRUE(
        says(message([](RasterRequest& r) { r.grid.projection = "+proj=longlat"; }), "unknown projection"));
    EXPECT_TRUE(
        says(message([](RasterRequest& r) { r.grid.projection = "+proj=tmerc +lon_0=2.5 +units=km"; }),
             "in metres"));
    EXPECT_TRUE(says(message([](RasterRequest& r) { r.open_depth = -4.0; }), "--open-depth"));
}

TEST_F(RasterImport, OpenSeaIsTheBordersMeanDepthUnlessGiven) {
    GeotiffSpec spec = around_place();
    spec.height = [](double, double) { return -37.5; };
    EXPECT_EQ(import(spec).grid.open_sea_depth, -37.5 * 1024);
    RasterRequest request = request_at(place);
    request.open_depth = 80.0;
    EXPECT_EQ(import(spec, request).grid.open_sea_depth, -80 * 1024);
}

TEST_F(RasterImport, DeepSeaTakesACoarserHeightStep) {
    GeotiffSpec spec = around_place();
    spec.height = [](double lon, double lat) { return -5000.0 + slope(lon, lat); };
    const TerrainGrid grid = import(spec).grid;
    EXPECT_EQ(grid.height_step_log2, 8);
    EXPECT_LT(largest_error(grid, place, spec.height), 0.125 + 1e-3);
}

TEST(FillMissing, RingsGrowInwardsFromTheMeanOfTheirNeighbours) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<float> samples{1, 1,   1,   1,   1,  //
                               1, nan, nan, nan, 3,  //
                               1, nan, nan, nan, 3,  //
                               1, nan, nan, nan, 3,  //
                               1, 1,   1,   1,   1};
    EXPECT_EQ(fill_missing(samples, 5, 5), 9U);
    EXPECT_FLOAT_EQ(samples[6], 1.0F);
    EXPECT_FLOAT_EQ(samples[8], (1 + 1 + 1 + 3 + 3) / 5.0F);
    EXPECT_FLOAT_EQ(samples[12], (1 + 1 + 1.8F + 1 + 3 + 1 + 1 + 1.8F) / 8.0F);
    std::vector<float> nothing(4, nan);
    EXPECT_EQ(fill_missing(nothing, 2, 2), 0U);
}

}  // namespace
}  // namespace trochoid
