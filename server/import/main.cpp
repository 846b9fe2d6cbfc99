#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>

#include "protocol/model/terrain_file.hpp"
#include "protocol/units/lattice.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"
#include "server/import/coast_import.hpp"
#include "server/import/in_child.hpp"
#include "server/import/raster_import.hpp"
#include "server/import/terrain_path.hpp"
#include "server/import/terrain_picture.hpp"

namespace {

using namespace trochoid;

/// Options in the form in which they are typed.
struct Options {
    std::string input;
    std::string output;
    std::vector<double> origin;
    std::vector<double> extent;
    std::string source;
    double nodata = std::numeric_limits<double>::quiet_NaN();
    RasterRequest raster;
    CoastRequest coast;
};

void add_grid_options(CLI::App& command, Options& options, GridRequest& grid) {
    command.add_option("--out", options.output, "Terrain file to write")->required();
    command
        .add_option("--origin", options.origin,
                    "Degrees LON,LAT of the world's x = z = 0 and of the grid's centre")
        ->required()
        ->delimiter(',')
        ->expected(2);
    command.add_option("--extent", options.extent, "Metres W,H from west to east and from north to south")
        ->required()
        ->delimiter(',')
        ->expected(2);
    command
        .add_option("--projection", grid.projection, "tmerc, laea, eqc, stere, utm or a PROJ string, metres")
        ->capture_default_str();
    command.add_option("--spacing", grid.spacing, "Metres between samples, a power of two")
        ->capture_default_str();
}

CLI::App* add_raster(CLI::App& app, Options& options) {
    CLI::App* raster =
        app.add_subcommand("raster", "Import a GeoTIFF, netCDF or 16-bit PNG of heights or depths in metres");
    raster->add_option("RASTER", options.input, "in.tif, in.nc (GEBCO, ETOPO, GMT) or in.png (with in.toml)")
        ->required();
    add_grid_options(*raster, options, options.raster.grid);
    const std::map<std::string, RasterSign> signs{
        {"auto", RasterSign::automatic}, {"up", RasterSign::up}, {"down", RasterSign::down}};
    raster
        ->add_option("--positive", options.raster.sign,
                     "Sign of the values: up (heights), down (depths) or auto")
        ->transform(CLI::CheckedTransformer(signs))
        ->default_str("auto");
    raster->add_option("--nodata", options.nodata, "Value of missing samples (instead of the file's own)");
    raster
        ->add_option("--open-depth", options.raster.open_depth,
                     "Metres of depth far outside (0: mean along the border)")
        ->capture_default_str();
    raster->add_option("--variable", options.raster.variable,
                       "Of a netCDF, the variable with the heights (default: elevation, z, Band1, ...)");
    raster->footer(
        "A PNG is 16-bit grayscale; the TOML file beside it, of the same name, says where and how high it is:\n"
        "  height_scale  = 0.03125   metres a count (required)\n"
        "  height_offset = -64.0     metres of count 0 (required)\n"
        "  positive      = \"up\"      or \"down\": depths\n"
        "  nodata        = 0         count of missing samples\n"
        "  projection    = \"+proj=...\"  PROJ string, metres; left out: longitude and latitude, degrees\n"
        "  bounds        = [west, south, east, north]  outer edges of the outer pixels; or both of\n"
        "  origin        = [west, north] edges of the first pixel, pixel_size = [eastwards, southwards]\n"
        "  source        = \"...\"     for the record");
    return raster;
}

CLI::App* add_coast(CLI::App& app, Options& options) {
    CLI::App* coast =
        app.add_subcommand("coast", "Make a terrain from a GeoJSON shore line, depths by Dean's profile");
    CoastRequest& request = options.coast;
    coast->add_option("SHORE.geojson", options.input, "Polygons or closed lines, longitude and latitude")
        ->required();
    add_grid_options(*coast, options, request.grid);
    coast->add_option("--dean-a", request.dean_a, "A of depth = A y^(2/3), m^(1/3)")->capture_default_str();
    coast->add_option("--max-depth", request.max_depth, "Metres that no depth exceeds; the open sea's depth")
        ->capture_default_str();
    coast->add_option("--land-top", request.land.top, "Metres that no (synthetic) hill exceeds")
        ->capture_default_str();
    coast->add_option("--land-slope", request.land.slope, "Rise of the (synthetic) land inland, m/m")
        ->capture_default_str();
    coast->add_option("--seed", request.land.seed, "Chooses the (synthetic) hills")->capture_default_str();
    coast->add_option("--source", options.source, "Where the shore line comes from, for the record");
    return coast;
}

void print_grid(const TerrainGrid& grid, const ImportReport& report) {
    const double spacing = to_metres(int64_t{1} << grid.spacing_log2);
    fmt::print("size        {} x {} samples, {:.6g} m apart, {:.6g} x {:.6g} km\n", grid.columns, grid.rows,
               spacing, spacing * (grid.columns - 1) / 1000.0, spacing * (grid.rows - 1) / 1000.0);
    fmt::print("corner      {:.6g} m east, {:.6g} m south of the origin\n", to_metres(grid.origin_x),
               to_metres(grid.origin_z));
    fmt::print("origin      longitude {:.6f}, latitude {:.6f}\n", grid.origin_lon, grid.origin_lat);
    fmt::print("projection  {}\n", grid.projection);
    fmt::print("heights     {:.2f} to {:.2f} m in steps of 1/{} m\n", report.lowest, report.highest,
               1024 >> grid.height_step_log2);
    fmt::print("land        {:.2f} %\n", 100.0 * report.land_share);
    fmt::print("open sea    {:.2f} m deep\n", -to_metres(grid.open_sea_depth));
    fmt::print("tiles       {} levels\n", tile_levels(grid));
    fmt::print("provenance  {}\n", grid.provenance);
    fmt::print("hash        {:016x}\n", terrain_hash(grid));
}

void finish_import(const Options& options, const ImportedTerrain& imported) {
    write_terrain(options.output, imported.grid);
    for (const std::string& note : imported.report.notes) fmt::print("note        {}\n", note);
    print_grid(imported.grid, imported.report);
    fmt::print("written     {}\n", options.output);
}

void set_place(const Options& options, GridRequest& grid) {
    grid.origin = {options.origin[0], options.origin[1]};
    grid.width = options.extent[0];
    grid.height = options.extent[1];
    if (!(std::fabs(grid.origin.lon) <= 360.0 && std::fabs(grid.origin.lat) <= 90.0))
        throw OperatorError(
            fmt::format("--origin {},{} is no place: give longitude, then latitude, in degrees",
                        grid.origin.lon, grid.origin.lat));
}

void run_raster(Options& options) {
    set_place(options, options.raster.grid);
    if (!std::isnan(options.nodata)) options.raster.nodata = options.nodata;
    finish_import(options, import_raster(options.input, options.raster));
}

void run_coast(Options& options) {
    set_place(options, options.coast.grid);
    options.coast.source =
        options.source.empty() ? std::filesystem::path(options.input).filename().string() : options.source;
    finish_import(options, import_coast(options.input, options.coast));
}

/// What went wrong is said on stderr: 0 or 2.
int guarded(const std::function<void()>& work) {
    try {
        work();
        return 0;
    } catch (const OperatorError& error) {
        fmt::print(stderr, "trochoid-import: {}\n", error.what());
    } catch (const std::bad_alloc&) {
        fmt::print(stderr,
                   "trochoid-import: not enough memory: give a smaller --extent or a coarser --spacing\n");
    } catch (const std::exception& error) {
        fmt::print(stderr, "trochoid-import: {}\n", error.what());
    }
    return 2;
}

int run(int argc, char** argv) {
    CLI::App app("Makes terrain for trochoid-server from real data");
    app.set_version_flag("--version", version_text("trochoid-import"));
    app.require_subcommand(1);
    app.footer(
        "Examples:\n"
        "  trochoid-import coast shore.geojson --out isles.terrain --origin -6.345,49.92 --extent 20480,20480\n"
        "  trochoid-import raster gebco.nc --out bay.terrain --origin 2.5,43 --extent 60000,60000 --spacing 128\n"
        "  trochoid-import picture isles.terrain isles.png");
    Options options;
    CLI::App* raster = add_raster(app, options);
    CLI::App* coast = add_coast(app, options);
    CLI::App* info = app.add_subcommand("info", "Print what a terrain file holds");
    info->add_option("FILE.terrain", options.input, "The terrain")->required();
    CLI::App* picture = app.add_subcommand("picture", "Draw a terrain as a shaded map");
    picture->add_option("FILE.terrain", options.input, "The terrain")->required();
    picture->add_option("OUT.png", options.output, "The picture to write")->required();
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    if (raster->parsed())
        return in_child(options.input, [&] { return guarded([&] { run_raster(options); }); });
    if (coast->parsed()) run_coast(options);
    if (info->parsed()) {
        const TerrainGrid grid = read_terrain(options.input);
        print_grid(grid, describe_heights(grid));
    }
    if (picture->parsed()) {
        write_picture(options.output, read_terrain(options.input));
        fmt::print("wrote {}\n", options.output);
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    int code = 2;
    const int failure = guarded([&] { code = run(argc, argv); });
    return failure != 0 ? failure : code;
}
