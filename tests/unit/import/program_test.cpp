// The program trochoid-import as an operator runs it, and the shipped coast as it makes it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "server/import/map_projection.hpp"
#include "server/import/terrain_path.hpp"
#include "tests/unit/import/geotiff_writer.hpp"

namespace trochoid {
namespace {

const std::string scilly = std::string(TROCHOID_SOURCE_DIR) + "/server/scenes/scilly/";

struct Outcome {
    int code = -1;
    std::string text;
};

/// Runs the program with shell-quoted arguments; text is what it wrote to both outputs.
Outcome run_import(const ScratchFolder& folder, const std::string& arguments) {
    const std::string command = std::string("'") + TROCHOID_BIN_DIR + "/trochoid-import' " + arguments +
                                " > '" + (folder / "said").string() + "' 2>&1";
    // NOLINTNEXTLINE(concurrency-mt-unsafe): a test has one thread here.
    const int status = std::system(command.c_str());
    std::ostringstream text;
    text << std::ifstream(folder / "said").rdbuf();
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text.str()};
}

TEST(ImportProgram, HelpAndVersion) {
    const ScratchFolder folder;
    const Outcome help = run_import(folder, "--help");
    EXPECT_EQ(help.code, 0);
    for (const char* word : {"raster", "coast", "info", "picture"})
        EXPECT_NE(help.text.find(word), std::string::npos) << word;
    const Outcome raster_help = run_import(folder, "raster --help");
    for (const char* word : {"--origin", "--positive", "--nodata", "--open-depth", "--spacing", "--extent",
                             "--variable", "height_scale"})
        EXPECT_NE(raster_help.text.find(word), std::string::npos) << word;
    const Outcome version = run_import(folder, "--version");
    EXPECT_EQ(version.code, 0);
    EXPECT_EQ(version.text.find("trochoid-import"), 0U);
}

TEST(ImportProgram, OperatorsMistakesGiveOneMessageAndExitTwo) {
    const ScratchFolder folder;
    EXPECT_EQ(run_import(folder, "").code, 2);
    EXPECT_EQ(run_import(folder, "raster --nonsense").code, 2);
    const std::string grid = " --out x.terrain --origin 2.5,43 --extent 1000,1000";
    const Outcome missing = run_import(folder, "raster absent.tif" + grid);
    EXPECT_EQ(missing.code, 2);
    EXPECT_EQ(missing.text, "trochoid-import: cannot open the raster absent.tif: check the path\n");
    EXPECT_EQ(run_import(folder, "raster absent.tif --positive sideways" + grid).code, 2);
    const Outcome place = run_import(folder, "raster a.tif --out x --origin 43,200 --extent 100,100");
    EXPECT_EQ(place.code, 2);
    EXPECT_NE(place.text.find("longitude, then latitude"), std::string::npos);
    EXPECT_EQ(run_import(folder, "info absent.terrain").code, 2);
    EXPECT_EQ(run_import(folder, "picture '" + scilly + "scilly.terrain' /nowhere/at/all.png").code, 2);
}

TEST(ImportProgram, RasterOptionsReachTheImporter) {
    const ScratchFolder folder;
    GeotiffSpec spec;
    spec.columns = spec.rows = 40;
    spec.first_x = 2.3;
    spec.first_y = 43.2;
    spec.step_x = 0.01;
    spec.step_y = -0.01;
    spec.height = [](double lon, double) { return lon > 2.6 ? -99.0 : 12.5; };
    write_geotiff(folder / "in.tif", spec);
    const std::string out = (folder / "out.terrain").string();
    const Outcome run = run_import(
        folder, "raster '" + (folder / "in.tif").string() + "' --out '" + out +
                    "' --origin 2.5,43 --extent 16000,8000 --spacing 256 --positive down --nodata -99 "
                    "--open-depth 70 --projection laea");
    ASSERT_EQ(run.code, 0) << run.text;
    const TerrainGrid grid = read_terrain(out);
    EXPECT_EQ(grid.columns, 64U);  // 62.5 cells round to 63
    EXPECT_EQ(grid.rows, 32U);
    EXPECT_EQ(grid.spacing_log2, 18U);
    EXPECT_EQ(grid.open_sea_depth, -70 * 1024);
    EXPECT_EQ(grid.projection.substr(0, 10), "+proj=laea");
    EXPECT_TRUE(std::all_of(grid.heights.begin(), grid.heights.end(), [](int16_t h) { return h == -400; }));
}

TEST(ShippedCoast, TheShippedShoreLineMakesTheShippedTerrain) {
    const ScratchFolder folder;
    std::ifstream file(scilly + "import.options");
    ASSERT_TRUE(file);
    std::string options, line;
    while (std::getline(file, line))
        if (!line.empty() && line[0] != '#') options += " '" + line + "'";
    const std::string out = (folder / "again.terrain").string();
    const Outcome run =
        run_import(folder, "coast '" + scilly + "shoreline.geojson' --out '" + out + "'" + options);
    ASSERT_EQ(run.code, 0) << run.text;
    TerrainGrid again = read_terrain(out);
    const TerrainGrid shipped = read_terrain(scilly + "scilly.terrain");
    ASSERT_EQ(again.heights.size(), shipped.heights.size());
    for (std::size_t i = 0; i < again.heights.size(); ++i)
        ASSERT_LE(std::abs(again.heights[i] - shipped.heights[i]), 1) << i;
    again.heights = shipped.heights;
    EXPECT_EQ(again, shipped);
}

TEST(ShippedCoast, PlacesAreWhereTheyAre) {
    const TerrainGrid grid = read_terrain(scilly + "scilly.terrain");
    const WorldMap map("tmerc", {grid.origin_lon, grid.origin_lat});
    const auto metres_at = [&](double lon, double lat) {
        const EastNorth at = map.to_world({lon, lat});
        return height_at(grid, std::llround(at.east * 1024), -std::llround(at.north * 1024)) / 1024.0;
    };
    EXPECT_GT(metres_at(-6.297, 49.920), 10.0);   // St Mary's
    EXPECT_GT(metres_at(-6.336, 49.955), 10.0);   // Tresco
    EXPECT_GT(metres_at(-6.349, 49.892), 5.0);    // St Agnes
    EXPECT_LT(metres_at(-6.325, 49.905), -3.0);   // St Mary's Sound
    EXPECT_LT(metres_at(-6.325, 49.930), -3.0);   // St Mary's Road
    EXPECT_LT(metres_at(-6.470, 49.840), -40.0);  // the open Atlantic
    const auto land =
        std::count_if(grid.heights.begin(), grid.heights.end(), [](int16_t h) { return h > 0; });
    // The polygons' area by the shoelace formula is 22.5 square kilometres.
    EXPECT_NEAR(static_cast<double>(land) * 0.032 * 0.032, 22.5, 0.5);
}

TEST(ShippedGrounds, TheShippedPicturesMakeTheShippedTerrains) {
    const ScratchFolder folder;
    const std::string grounds = std::string(TROCHOID_SOURCE_DIR) + "/server/scenes/grounds/";
    for (const char* name : {"beach", "island", "harbour"}) {
        const TerrainGrid shipped = read_terrain(grounds + name + ".terrain");
        const std::string out = (folder / "again.terrain").string();
        const int metres = static_cast<int>(shipped.columns - 1) * 16;
        const Outcome run = run_import(folder, "raster '" + grounds + name + ".png' --out '" + out +
                                                   "' --origin 0,0 --spacing 16 --extent " +
                                                   std::to_string(metres) + "," + std::to_string(metres));
        ASSERT_EQ(run.code, 0) << run.text;
        EXPECT_EQ(read_terrain(out), shipped) << name;
    }
}

TEST(ShippedCoast, InfoAndPicture) {
    const ScratchFolder folder;
    const Outcome info = run_import(folder, "info '" + scilly + "scilly.terrain'");
    EXPECT_EQ(info.code, 0);
    for (const char* word : {"641 x 641", "32 m apart", "+proj=tmerc", "synthetic", "hash"})
        EXPECT_NE(info.text.find(word), std::string::npos) << word;
    const std::string png = (folder / "map.png").string();
    EXPECT_EQ(run_import(folder, "picture '" + scilly + "scilly.terrain' '" + png + "'").code, 0);
    EXPECT_GT(std::filesystem::file_size(png), 50'000U);
}

}  // namespace
}  // namespace trochoid
