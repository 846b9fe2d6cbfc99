// netCDF and PNG rasters against the GeoTIFF of the same samples: the imported grids are equal to the value.
#include <gtest/gtest.h>
#include <netcdf.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "server/import/map_projection.hpp"
#include "server/import/netcdf_file.hpp"
#include "server/import/raster_import.hpp"
#include "tests/unit/import/geotiff_writer.hpp"
#include "tests/unit/import/raster_writers.hpp"

namespace trochoid {
namespace {

constexpr LonLat place{2.5, 43.0};

/// Whole metres, so that every sample type holds the same value; neither symmetric nor linear.
double hills(double lon, double lat) {
    return std::round(300.0 * (lon - 2.48) + 170.0 * (lat - 43.03) +
                      90.0 * std::sin(9.0 * lon) * std::cos(7.0 * lat));
}

NetcdfSpec gebco_like() {
    NetcdfSpec spec;
    spec.columns = 60;
    spec.rows = 50;
    spec.first_x = 2.205;
    spec.first_y = 42.755;
    spec.step_x = spec.step_y = 0.01;
    spec.height = hills;
    return spec;
}

GeotiffSpec same_raster(const NetcdfSpec& spec) {
    GeotiffSpec tiff;
    tiff.columns = static_cast<uint32_t>(spec.columns);
    tiff.rows = static_cast<uint32_t>(spec.rows);
    tiff.first_x = spec.first_x;
    tiff.first_y = spec.first_y;
    tiff.step_x = spec.step_x;
    tiff.step_y = spec.step_y;
    tiff.height = spec.height;
    return tiff;
}

RasterRequest request_at(LonLat origin, double side = 16'384.0, double spacing = 512.0) {
    RasterRequest request;
    request.grid.origin = origin;
    request.grid.width = request.grid.height = side;
    request.grid.spacing = spacing;
    return request;
}

bool says(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

class RasterFormats : public testing::Test {
protected:
    TerrainGrid from_tiff(const GeotiffSpec& spec, const RasterRequest& request = request_at(place)) {
        write_geotiff(folder_ / "in.tif", spec);
        return comparable(import_raster(folder_ / "in.tif", request));
    }
    TerrainGrid from_netcdf(const NetcdfSpec& spec, const RasterRequest& request = request_at(place)) {
        write_netcdf(folder_ / "in.nc", spec);
        return comparable(import_raster(folder_ / "in.nc", request));
    }
    std::string netcdf_refusal(const NetcdfSpec& spec, const RasterRequest& request = request_at(place)) {
        return operator_error_of([&] { from_netcdf(spec, request); });
    }
    /// Without the file's name.
    static TerrainGrid comparable(ImportedTerrain imported) {
        imported.grid.provenance.clear();
        return imported.grid;
    }
    std::filesystem::path png(const PngSpec& spec, const std::string& sidecar) {
        write_png(folder_ / "in.png", spec);
        std::ofstream(folder_ / "in.toml") << sidecar;
        return folder_ / "in.png";
    }
    ScratchFolder folder_;
};

TEST_F(RasterFormats, NetcdfIsTheGeotiffToTheValueInEveryFormatAndType) {
    const TerrainGrid expected = from_tiff(same_raster(gebco_like()));
    for (const auto format :
         {NetcdfSpec::Format::classic, NetcdfSpec::Format::offset_64, NetcdfSpec::Format::netcdf4}) {
        for (const int type : {NC_SHORT, NC_INT, NC_FLOAT, NC_DOUBLE}) {
            NetcdfSpec spec = gebco_like();
            spec.format = format;
            spec.type = type;
            EXPECT_EQ(from_netcdf(spec), expected) << int(format) << ' ' << type;
        }
    }
    NetcdfSpec chunked = gebco_like();
    chunked.chunk = 7;
    chunked.with_time = true;
    EXPECT_EQ(from_netcdf(chunked), expected);
}

TEST_F(RasterFormats, NetcdfRowsAndColumnsEitherWayUnderEveryName) {
    const TerrainGrid expected = from_tiff(same_raster(gebco_like()));
    for (const auto& [x, y, variable] :
         {std::tuple{"lon", "lat", "elevation"}, std::tuple{"longitude", "latitude", "z"},
          std::tuple{"x", "y", "z"}, std::tuple{"lon", "lat", "Band1"}, std::tuple{"LON", "LAT", "ROSE"},
          std::tuple{"ETOPO05_X", "ETOPO05_Y", "ROSE"}}) {
        NetcdfSpec spec = gebco_like();
        if (x[0] == 'E') spec.axis_units = "CF";
        spec.x_name = x;
        spec.y_name = y;
        spec.variable = variable;
        spec.first_y = 43.245;
        spec.step_y = -0.01;
        // The same places in another order differ by a rounding of the axis, nothing more.
        const TerrainGrid flipped = from_netcdf(spec);
        ASSERT_EQ(flipped.heights.size(), expected.heights.size());
        for (std::size_t i = 0; i < expected.heights.size(); ++i)
            ASSERT_NEAR(flipped.heights[i], expected.heights[i], 1) << variable << ' ' << i;
        EXPECT_EQ(flipped, from_tiff(same_raster(spec)));
    }
    NetcdfSpec westwards = gebco_like();
    westwards.first_x = 2.795;
    westwards.step_x = -0.01;
    const TerrainGrid turned = from_netcdf(westwards);
    for (std::size_t i = 0; i < expected.heights.size(); ++i)
        ASSERT_NEAR(turned.heights[i], expected.heights[i], 1);
}

TEST_F(RasterFormats, NetcdfScaleOffsetAndMarks) {
    const auto hole = [](double lon, double lat) {
        return std::fabs(lon - 2.5) < 0.016 && std::fabs(lat - 43.0) < 0.016;
    };
    GeotiffSpec tiff = same_raster(gebco_like());
    tiff.nodata = "-9999";
    tiff.height = [&](double lon, double lat) { return hole(lon, lat) ? -9999.0 : hills(lon, lat); };
    const TerrainGrid expected = from_tiff(tiff);
    struct Case {
        int type;
        std::optional<double> fill, missing;
        double marker, scale, offset;
        std::optional<double> option;
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Case& c :
         {Case{NC_SHORT, -32768.0, {}, -32768.0, 1.0, 0.0, {}},
          // The type's default fill value, and one that scale and offset do not apply to.
          Case{NC_SHORT, {}, {}, NC_FILL_SHORT, 1.0, 0.0, {}}, Case{NC_SHORT, {}, -1.0, -1.0, 0.5, 250.0, {}},
          Case{NC_INT, -5.0, -6.0, -6.0, 0.25, 1000.0, {}}, Case{NC_FLOAT, {}, {}, nan, 1.0, 0.0, {}},
          Case{NC_FLOAT, 0.1, {}, 0.1, 1.0, 0.0, {}},
          Case{NC_FLOAT, 1e30, {}, -77777.0, 1.0, 0.0, -77777.0}}) {
        NetcdfSpec spec = gebco_like();
        spec.type = c.type;
        spec.fill = c.fill;
        spec.missing = c.missing;
        spec.scale_factor = c.scale;
        spec.add_offset = c.offset;
        spec.height = [&](double lon, double lat) {
            return hole(lon, lat) ? c.marker * c.scale + c.offset : hills(lon, lat);
        };
        RasterRequest request = request_at(place);
        request.nodata = c.option;
        EXPECT_EQ(from_netcdf(spec, request), expected) << c.type << ' ' << c.marker;
    }
}

TEST_F(RasterFormats, NetcdfStatesItsSign) {
    NetcdfSpec spec = gebco_like();
    spec.height = [](double, double) { return 30.0; };
    EXPECT_GT(from_netcdf(spec).heights[0], 0);  // "elevation"
    spec.variable = "depth";
    EXPECT_LT(from_netcdf(spec).heights[0], 0);
    spec.positive = "up";
    EXPECT_GT(from_netcdf(spec).heights[0], 0);
    spec.positive = "down";
    spec.variable = "z";
    EXPECT_LT(from_netcdf(spec).heights[0], 0);
    spec.positive = "";
    EXPECT_TRUE(says(netcdf_refusal(spec), "--positive down or --positive up"));
}

TEST_F(RasterFormats, NetcdfAroundTheGlobeAndOverTheDateLine) {
    for (const double first : {0.5, -179.5})
        for (const double origin_lon : {180.0, -179.7, 0.2, 359.8}) {
            NetcdfSpec spec;
            spec.columns = 360;
            spec.rows = 180;
            spec.first_x = first;
            spec.first_y = -89.5;
            spec.step_x = spec.step_y = 1.0;
            spec.type = NC_FLOAT;
            spec.float_axes = true;
            spec.height = [&](double lon, double lat) {
                return std::round(8.0 * wrap_degrees(lon - origin_lon) - lat);
            };
            RasterRequest request = request_at({origin_lon, 12.0}, 262'144.0, 1024.0);
            request.sign = RasterSign::up;
            const TerrainGrid expected = from_tiff(same_raster(spec), request);
            EXPECT_EQ(from_netcdf(spec, request), expected) << first << ' ' << origin_lon;
        }
    // A regional cut whose longitudes jump from 180 to -180.
    NetcdfSpec cut = gebco_like();
    cut.first_x = 179.705;
    cut.height = [](double lon, double lat) { return hills(wrap_degrees(lon - 180.0) + 2.5, lat); };
    const TerrainGrid expected = from_tiff(same_raster(cut), request_at({-180.0, 43.0}));
    cut.wrapped = true;
    EXPECT_EQ(from_netcdf(cut, request_at({-180.0, 43.0})), expected);
}

TEST_F(RasterFormats, NetcdfVariableIsChosenOrAskedFor) {
    NetcdfSpec spec = gebco_like();
    spec.variable = "bed";
    spec.also = "ice";
    const std::string ask = netcdf_refusal(spec);
    EXPECT_TRUE(says(ask, "bed, ice") && says(ask, "--variable")) << ask;
    RasterRequest request = request_at(place);
    request.variable = "bed";
    EXPECT_EQ(from_netcdf(spec, request), from_tiff(same_raster(gebco_like())));
    request.variable = "bad";
    EXPECT_TRUE(says(netcdf_refusal(spec, request), "no variable 'bad'"));
    request.variable = "lat";
    EXPECT_TRUE(says(netcdf_refusal(spec, request), "no grid"));
    // A well-known name wins.
    spec.variable = "z";
    EXPECT_EQ(from_netcdf(spec), from_tiff(same_raster(gebco_like())));
    // Other formats have no variables.
    write_geotiff(folder_ / "in.tif", same_raster(spec));
    EXPECT_TRUE(says(operator_error_of([&] { import_raster(folder_ / "in.tif", request); }), "--variable"));
}

TEST_F(RasterFormats, NetcdfThatIsNoHeightRasterIsRefused) {
    const auto message = [&](auto change) {
        NetcdfSpec spec = gebco_like();
        change(spec);
        return netcdf_refusal(spec);
    };
    EXPECT_TRUE(says(message([](NetcdfSpec& s) { s.without_axes = true; }), "there are: elevation"));
    EXPECT_TRUE(
        says(message([](NetcdfSpec& s) { s.transposed = true; }), "no variable over 1-D coordinates"));
    EXPECT_TRUE(
        says(message([](NetcdfSpec& s) { s.x_name = "easting"; }), "no variable over 1-D coordinates"));
    EXPECT_TRUE(says(message([](NetcdfSpec& s) { s.axis_units = "m"; }), "not in degrees"));
    EXPECT_TRUE(says(message([](NetcdfSpec& s) { s.units = "feet"; }), "in feet"));
    EXPECT_TRUE(says(message([](NetcdfSpec& s) { s.bend = 0.5; }), "not evenly spaced"));
    EXPECT_TRUE(says(message([](NetcdfSpec& s) {
                         s.step_y = 4.0;
                         s.height = [](double, double) { return 0.0; };
                     }),
                     "not evenly spaced degrees"));
    EXPECT_TRUE(says(message([](NetcdfSpec& s) { s.step_x = 0.0; }), "not evenly spaced"));
    EXPECT_TRUE(says(message([](NetcdfSpec& s) { s.rows = 1; }), "fewer than 2"));
    EXPECT_TRUE(says(message([](NetcdfSpec& s) { s.type = NC_INT64; }), "holds no numbers"));
    EXPECT_TRUE(says(message([](NetcdfSpec& s) {
                         s.type = NC_FLOAT;
                         s.height = [](double, double) { return std::nan(""); };
                     }),
                     "100 % of the samples here are missing"));
    EXPECT_TRUE(says(message([](NetcdfSpec& s) { s.first_x += 1.0; }), "outside the raster"));
    EXPECT_TRUE(says(message([](NetcdfSpec& s) {
                         s.columns = NetcdfFile::side_max + 1;
                         s.rows = 2;
                         s.format = NetcdfSpec::Format::classic;
                         s.height = [](double, double) { return 0.0; };
                     }),
                     "absurd"));
}

TEST_F(RasterFormats, TornNetcdfGivesOneMessageAndNeverCrashes) {
    for (const auto format :
         {NetcdfSpec::Format::classic, NetcdfSpec::Format::offset_64, NetcdfSpec::Format::netcdf4}) {
        NetcdfSpec spec = gebco_like();
        spec.format = format;
        if (format == NetcdfSpec::Format::netcdf4) spec.chunk = 10;
        write_netcdf(folder_ / "whole.nc", spec);
        std::ifstream whole(folder_ / "whole.nc", std::ios::binary);
        const std::string bytes((std::istreambuf_iterator<char>(whole)), {});
        for (std::size_t length = 0; length + 8 < bytes.size(); length += 101) {
            std::ofstream(folder_ / "torn.nc", std::ios::binary) << bytes.substr(0, length);
            EXPECT_NE(operator_error_of([&] { import_raster(folder_ / "torn.nc", request_at(place)); }), "")
                << int(format) << ' ' << length << " of " << bytes.size();
        }
    }
}

const char* const sidecar_by_bounds =
    "height_scale = 1.0\nheight_offset = -700.0\nbounds = [2.2, 42.75, 2.8, 43.25]\nsource = \"A test.\"\n";

PngSpec png_of_hills() {
    PngSpec spec;
    spec.columns = 60;
    spec.rows = 50;
    spec.count = [](uint32_t c, uint32_t r) {
        // A picture much too large (a test below) climbs beyond 16 bits.
        const double count = hills(2.205 + 0.01 * c, 43.245 - 0.01 * r) + 700.0;
        return static_cast<uint16_t>(std::min(count, 65535.0));
    };
    return spec;
}

GeotiffSpec tiff_of_hills() {
    GeotiffSpec tiff = same_raster(gebco_like());
    tiff.first_y = 43.245;
    tiff.step_y = -0.01;
    return tiff;
}

void expect_within_a_count(const TerrainGrid& got, const TerrainGrid& expected) {
    ASSERT_EQ(got.heights.size(), expected.heights.size());
    std::size_t unequal = 0;
    for (std::size_t i = 0; i < got.heights.size(); ++i) {
        ASSERT_NEAR(got.heights[i], expected.heights[i], 1) << i;
        unequal += got.heights[i] != expected.heights[i] ? 1U : 0U;
    }
    // Edges and pixel sizes divide differently in the last place; a height on a rounding boundary may go either way.
    EXPECT_LE(unequal, got.heights.size() / 100);
}

TEST_F(RasterFormats, PngIsTheGeotiffUnderBothPlacements) {
    const TerrainGrid expected = from_tiff(tiff_of_hills());
    PngSpec spec = png_of_hills();
    const ImportedTerrain imported = import_raster(png(spec, sidecar_by_bounds), request_at(place));
    EXPECT_TRUE(says(imported.grid.provenance, "A test."));
    expect_within_a_count(imported.grid, expected);
    spec.interlaced = true;
    const ImportedTerrain by_size = import_raster(
        png(spec, "height_scale = 1\nheight_offset = -700\npixel_size = [0.01, 0.01]\norigin = [2.2, 43.25]"),
        request_at(place));
    expect_within_a_count(by_size.grid, expected);
}

TEST_F(RasterFormats, PngInMetresAlignedWithTheGridIsExact) {
    PngSpec spec;
    spec.columns = spec.rows = 33;
    spec.count = [](uint32_t c, uint32_t r) { return static_cast<uint16_t>(c * 1500 + r * 37); };
    RasterRequest request = request_at({0, 0}, 512.0, 16.0);
    const TerrainGrid grid =
        import_raster(
            png(spec,
                "height_scale = 0.0625\nheight_offset = -2000.0\nprojection = \"+proj=tmerc +lon_0=0 "
                "+lat_0=0 +ellps=WGS84\"\norigin = [-264.0, 264.0]\npixel_size = [16.0, 16.0]\n"),
            request)
            .grid;
    ASSERT_EQ(grid.columns, 33U);
    for (uint32_t r = 0; r < 33; ++r)
        for (uint32_t c = 0; c < 33; ++c)
            EXPECT_NEAR(std::ldexp(grid.heights[r * 33 + c], grid.height_step_log2 - 10),
                        (c * 1500 + r * 37) * 0.0625 - 2000.0,
                        0.5 * std::ldexp(1.0, grid.height_step_log2 - 10) + 1e-3);
}

TEST_F(RasterFormats, PngDepthsAndMissingCounts) {
    PngSpec spec = png_of_hills();
    spec.count = [](uint32_t c, uint32_t r) {
        const bool hole = c >= 28 && c < 32 && r >= 23 && r < 27;
        return static_cast<uint16_t>(hole ? 65535 : 1000 + 10 * c);
    };
    const ImportedTerrain imported =
        import_raster(png(spec, std::string(sidecar_by_bounds) + "positive = \"down\"\nnodata = 65535\n"),
                      request_at(place));
    EXPECT_TRUE(std::any_of(imported.report.notes.begin(), imported.report.notes.end(),
                            [](const std::string& n) { return says(n, "16 missing samples"); }));
    EXPECT_LT(imported.report.highest, -300.0);
    EXPECT_GT(imported.report.lowest, -900.0);
}

TEST_F(RasterFormats, PngsThatAreNoHeightsAreRefused) {
    const auto picture = [&](auto change) {
        PngSpec spec = png_of_hills();
        change(spec);
        return operator_error_of([&] { import_raster(png(spec, sidecar_by_bounds), request_at(place)); });
    };
    EXPECT_EQ(picture([](PngSpec&) {}), "");
    EXPECT_TRUE(says(picture([](PngSpec& s) { s.bits = 8; }), "16-bit grayscale"));
    EXPECT_TRUE(says(picture([](PngSpec& s) { s.colour_type = PNG_COLOR_TYPE_RGB; }), "3 channels"));
    EXPECT_TRUE(
        says(picture([](PngSpec& s) { s.colour_type = PNG_COLOR_TYPE_GRAY_ALPHA; }), "without alpha"));
    EXPECT_TRUE(says(picture([](PngSpec& s) { s.rows = 1; }), "fewer than 2"));
    EXPECT_TRUE(says(picture([](PngSpec& s) {
                         s.columns = 40'000;
                         s.rows = 2;
                     }),
                     "damaged or too large"));

    const std::filesystem::path path = png(png_of_hills(), sidecar_by_bounds);
    std::ifstream whole(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(whole)), {});
    for (std::size_t length = 0; length + 12 < bytes.size(); length += 61) {
        std::ofstream(path, std::ios::binary) << bytes.substr(0, length);
        EXPECT_NE(operator_error_of([&] { import_raster(path, request_at(place)); }), "") << length;
    }
    std::filesystem::remove(folder_ / "in.toml");
    write_png(folder_ / "lone.png", png_of_hills());
    EXPECT_TRUE(says(operator_error_of([&] { import_raster(folder_ / "lone.png", request_at(place)); }),
                     "lone.toml is missing"));
}

TEST_F(RasterFormats, SidecarsMistakesAreNamed) {
    const std::string heights = "height_scale = 1.0\nheight_offset = -700.0\n";
    const std::string bounds = "bounds = [2.2, 42.75, 2.8, 43.25]\n";
    struct Case {
        std::string text;
        const char* part;
    };
    for (const Case& c :
         {Case{heights, "bounds is missing"}, Case{"height_scale = 1\n" + bounds, "height_offset is missing"},
          Case{"height_offset = 1\n" + bounds, "height_scale is missing"},
          Case{"height_scale = 0\nheight_offset = 0\n" + bounds, "height_scale is not above 0"},
          Case{"height_scale = \"1\"\nheight_offset = 0\n" + bounds, "height_scale is no number"},
          Case{heights + bounds + "colour = 3\n", "colour is unknown"},
          Case{heights + bounds + "positive = \"left\"\n", "neither \"up\" nor \"down\""},
          Case{heights + bounds + "nodata = 70000\n", "0 to 65535"},
          Case{heights + bounds + "projection = \"+proj=nonsense\"\n", "unknown projection"},
          Case{heights + bounds + "origin = [1, 2]\n", "stands beside"},
          Case{heights + "bounds = [2.8, 42.75, 2.2, 43.25]\n", "east not above west"},
          Case{heights + "bounds = [2.2, 42.75, 2.8]\n", "give these 4 numbers"},
          Case{heights + "bounds = [2200, 42.75, 2800, 43.25]\n", "on the globe"},
          Case{heights + "origin = [2.2, 43.25]\n", "bounds is missing"},
          Case{heights + "origin = [2.2, 43.25]\npixel_size = [0.01, 0]\n", "pixel_size"},
          Case{heights + bounds + "x y\n", "not TOML"}}) {
        const std::string message =
            operator_error_of([&] { import_raster(png(png_of_hills(), c.text), request_at(place)); });
        EXPECT_TRUE(says(message, c.part)) << message << " for " << c.text;
        EXPECT_TRUE(says(message, "in.toml") || says(message, "projection")) << message;
    }
}

}  // namespace
}  // namespace trochoid
