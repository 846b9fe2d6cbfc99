// Every scene in server/scenes opens, is listed, and shows what its comment says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "protocol/model/terrain_file.hpp"
#include "server/app/opening.hpp"
#include "server/event/scene.hpp"
#include "server/world/steepness.hpp"
#include "server/world/train_spectrum.hpp"
#include "tests/determinism/folded_scene.hpp"

namespace trochoid {
namespace {

const std::filesystem::path folder = std::filesystem::path(TROCHOID_SOURCE_DIR) / "server" / "scenes";

std::string text_of(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

std::vector<std::string> scene_names() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (std::filesystem::exists(entry.path() / "scene.toml")) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

FoldedScene opened(const std::string& name) { return fold_scene(folder / name / "scene.toml", 2); }

const WaveTrainBox& record(const FoldedScene& scene, uint32_t box) {
    return scene.state->boxes.at({box})->sea->record;
}

double height_of(const FoldedScene& scene, uint32_t box) {
    return significant_height(record(scene, box).trains);
}

LatticePoint metres(double x, double z) { return {to_lattice(x), to_lattice(z)}; }

/// Root mean square height, metres, over points around a place.
double roughness(const SeaInstant& sea, LatticePoint around, double reach = 100.0) {
    double squares = 0.0;
    constexpr int side = 9;
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            const LatticePoint step = metres((i - 4) * reach / 4.3, (j - 4) * reach / 4.7);
            const double y = sea.evaluate({around.x + step.x, around.z + step.z}).ay;
            squares += y * y;
        }
    return std::sqrt(squares / (side * side));
}

class EveryScene : public testing::TestWithParam<std::string> {};

TEST_P(EveryScene, OpensAndMoves) {
    const FoldedScene scene = opened(GetParam());
    ASSERT_FALSE(scene.state->boxes.empty());
    // Its boxes have risen when the doors open.
    const SeaInstant now(scene.state->sea, scene.opens, displayed_layers);
    const SeaInstant later(scene.state->sea, scene.opens + 700'000, displayed_layers);
    double most = 0.0;
    double change = 0.0;
    for (const LiveBox& live : now.live()) {
        const WaveTrainBox& box = live.box->record;
        const int64_t u = box.length == 0 ? 0 : live.instant.front / 2;
        const int64_t v = box.width / 2;
        const LatticePoint middle{live.instant.origin.x + ((u * box.ux - v * box.uz) >> 30),
                                  live.instant.origin.z + ((u * box.uz + v * box.ux) >> 30)};
        for (int64_t i = 0; i < 60; ++i) {
            const LatticePoint p{middle.x + i * 11'003, middle.z - i * 7001};
            most = std::max(most, std::fabs(double{now.evaluate(p).ay}));
            change = std::max(change, std::fabs(double{now.evaluate(p).ay} - double{later.evaluate(p).ay}));
        }
    }
    EXPECT_GT(most, 1e-4);
    EXPECT_GT(change, 1e-5);
}

TEST_P(EveryScene, IsSmallListedAndExplained) {
    const std::string& name = GetParam();
    const std::string text = text_of(folder / name / "scene.toml");
    EXPECT_LT(text.size(), 16'384U);
    EXPECT_EQ(text.rfind("# ", 0), 0U) << "a comment on top says what it shows";
    EXPECT_NE(text_of(folder / "README.md").find("`" + name + "`"), std::string::npos);
    EXPECT_EQ(load_scene(folder / name / "scene.toml").name, name == "open-sea" ? "open sea" : name);
}

INSTANTIATE_TEST_SUITE_P(Shipped, EveryScene, testing::ValuesIn(scene_names()), [](const auto& scene) {
    std::string name = scene.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

TEST(ShippedScenes, AreManyAndGroundsAreSmall) {
    EXPECT_GE(scene_names().size(), 20U);
    for (const auto& entry : std::filesystem::directory_iterator(folder / "grounds"))
        EXPECT_LT(entry.file_size(), 100'000U) << entry.path();
}

TEST(ShippedScenes, SpectraHaveTheHeightsThatTheirPapersSay) {
    constexpr double g = 9.80665;
    EXPECT_NEAR(height_of(opened("pierson-moskowitz"), 1), 0.2092 * 15 * 15 / g, 0.05);
    // JONSWAP's height grows with the fetch as x^0.557 with wind at 10 m, until the sea is fully developed.
    const double u10 = 12.0 / 1.060;
    const auto jonswap = [&](double fetch) {
        return 0.00126 * std::pow(g * fetch / (u10 * u10), 0.557) * u10 * u10 / g;
    };
    const FoldedScene near_shore = opened("jonswap-short-fetch");
    const FoldedScene ocean = opened("jonswap-long-fetch");
    EXPECT_NEAR(height_of(near_shore, 1), jonswap(12e3), 0.05);
    EXPECT_GT(jonswap(400e3), 0.2092 * 12 * 12 / g);
    EXPECT_NEAR(height_of(ocean, 1), 0.2092 * 12 * 12 / g, 0.1);
    EXPECT_NEAR(height_of(opened("neumann"), 1), 0.00707 * std::pow(16 * 0.974 / 1.060, 2.5), 0.15);
    EXPECT_NEAR(height_of(opened("breeze-2"), 1), 0.085, 0.02);
    EXPECT_GT(height_of(opened("storm-40"), 1), 20.0);
}

TEST(ShippedScenes, PartitionIsSixteenFrequenciesOfSevenDirections) {
    const FoldedScene scene = opened("spectrum-partition");
    const auto& trains = record(scene, 1).trains;
    ASSERT_EQ(trains.size(), 112U);
    // The seven of one frequency stand together; what quantising the wave vector leaves is far below their distance.
    std::set<long> periods;
    for (const WaveTrain& train : trains) {
        periods.insert(std::lround(1e4 * std::log(static_cast<double>(train.omega))));
        // Within 60 degrees of north.
        EXPECT_LT(std::fabs(std::atan2(double(train.kx), double(-train.kz))), 1.0472 + 1e-3);
    }
    EXPECT_LE(periods.size(), 40U);
    EXPECT_GE(periods.size(), 16U);
}

TEST(ShippedScenes, SteepnessStaysBelowItsGuardInTheWorst) {
    for (const char* name : {"storm-40", "fifty-boxes", "crossing-swells"}) {
        const FoldedScene scene = opened(name);
        const SeaInstant now(scene.state->sea, scene.opens);
        for (int i = 0; i < 400; ++i)
            ASSERT_GT(now.evaluate(metres(i * 3.7 - 740, 611 - i * 2.9)).ny, 0.0F)
                << name << ": a crest folds";
    }
    EXPECT_EQ(opened("fifty-boxes").state->boxes.size(), 50U);
}

TEST(ShippedScenes, NoiseIsWhereItIsAskedFor) {
    const FoldedScene ripples = opened("capillary-ripples");
    const LatticePoint calm = metres(5000, 5000);
    EXPECT_EQ(roughness(SeaInstant(ripples.state->sea, ripples.opens), calm, 3.0), 0.0);
    EXPECT_GT(roughness(SeaInstant(ripples.state->sea, ripples.opens, displayed_layers), calm, 3.0), 1e-4);
    const FoldedScene noise = opened("gradient-noise");
    EXPECT_GT(roughness(SeaInstant(noise.state->sea, noise.opens), metres(-9e5, 4e5)), 0.1);
}

TEST(ShippedScenes, StormAndShipsMove) {
    const FoldedScene storm = opened("storm-cell");
    const auto corner = [&](int64_t seconds) {
        return instant_of(record(storm, 1), storm.opens + seconds * microseconds_per_second).origin;
    };
    // 4 m/s for an hour and 12 m/s for two, the last two hours due east.
    EXPECT_NEAR(to_metres(corner(10'800).x - corner(3600).x), 12.0 * 7200, 1.0);
    EXPECT_NEAR(to_metres(corner(10'800).z - corner(3600).z), 0.0, 1.0);
    EXPECT_NEAR(to_metres(corner(3600).x - corner(0).x), 4.0 * 3600 * std::sqrt(0.5), 1.0);

    const FoldedScene ships = opened("ship-wakes");
    size_t wakes = 0;
    for (const auto& [id, box] : ships.state->boxes)
        wakes += box->sea->record.wake.inverse_length != 0 ? 1U : 0U;
    EXPECT_EQ(wakes, 5U);  // five courses of three ships
    // The launch has stopped by a minute after the opening, and lies there since; her hull is the scene's.
    const auto lies =
        std::find_if(ships.state->boxes.begin(), ships.state->boxes.end(), [](const auto& entry) {
            const WaveTrainBox& box = entry.second->sea->record;
            return has_hull(box.hull) && !has_wake(box.wake);
        });
    ASSERT_NE(lies, ships.state->boxes.end());
    EXPECT_EQ(lies->second->name, "launch");
    EXPECT_EQ(lies->second->sea->record.hull, (Hull{14.0F, 2.0F}));
    EXPECT_EQ(lies->second->sea->record.begin, SeaTime{45 * microseconds_per_second});
    // The freighter has sailed 300 s at 8 m/s: behind her the water is rougher than abeam, outside the wedge.
    const SeaInstant now(ships.state->sea, ships.opens);
    EXPECT_GT(roughness(now, metres(-150, 300), 60), 1.1 * roughness(now, metres(-150, 2000), 60));
}

/// Mean gain of all boxes' land fields at a place.
double land_gain(const FoldedScene& scene, LatticePoint p) {
    double sum = 0.0;
    int fields = 0;
    for (const auto& [id, box] : scene.state->boxes)
        for (const auto& field : box->sea->fields) {
            sum += static_cast<double>(field->sample(p).gain) / 16'777'216.0;
            ++fields;
        }
    EXPECT_GT(fields, 0);
    return sum / std::max(fields, 1);
}

TEST(ShippedScenes, BreakwaterShelters) {
    const FoldedScene scene = opened("breakwater");
    EXPECT_LT(land_gain(scene, metres(420, 0)), 0.4);
    EXPECT_GT(land_gain(scene, metres(100, 0)), 0.9);
    const TerrainGrid before = *load_terrain(folder / "grounds" / "beach.terrain");
    EXPECT_LT(height_at(before, to_lattice(340), 0), -5 * 1024);
    EXPECT_GT(height_at(*scene.state->terrain, to_lattice(340), 0), 2 * 1024);
}

TEST(ShippedScenes, IslandCastsAShadowAndTheHarbourIsCalm) {
    const FoldedScene island = opened("circular-island");
    // Waves travel towards 70 degrees: the lee lies east-north-east.
    EXPECT_LT(land_gain(island, metres(400, -146)), 0.35);
    EXPECT_GT(land_gain(island, metres(-600, 218)), 0.9);
    const FoldedScene harbour = opened("harbour");
    EXPECT_LT(land_gain(harbour, metres(400, 0)), 0.5 * land_gain(harbour, metres(400, 500)));
    EXPECT_GT(land_gain(harbour, metres(0, 100)), land_gain(harbour, metres(400, 0)));
}

TEST(ShippedScenes, BeachTurnsTheCrests) {
    const FoldedScene scene = opened("plane-beach");
    const auto& box = *scene.state->boxes.at({1})->sea;
    const TrainConstants& wave = box.constants[0];
    // Snell's law over straight contours: the wave number along the shore stays, the one across it grows.
    const LandSample shallow = box.fields[0]->sample(metres(500, 0));
    EXPECT_NEAR(double{shallow.dshift_dz}, 0.0, 0.15 * std::fabs(double{wave.kz}));
    EXPECT_GT(shallow.dshift_dx, 0.1F * wave.kx);
    EXPECT_GT(shallow.orbit, 1.05F);
}

TEST(ShippedScenes, OldAndFarSeasAreAsRoughAsYoungOnes) {
    const FoldedScene far = opened("old-and-far");
    EXPECT_EQ(far.opens.us, 2'592'000 * microseconds_per_second);
    const SeaInstant now(far.state->sea, far.opens);
    const double expected = height_of(far, 1) / 4.0;
    EXPECT_NEAR(roughness(now, metres(9'000'000, 2'000'000), 900), expected, 0.35 * expected);
    const FoldedScene old = opened("ten-years");
    EXPECT_EQ(old.opens.us, 315'576'000 * microseconds_per_second);
    EXPECT_GT(roughness(SeaInstant(old.state->sea, old.opens), {0, 0}), 0.3);
}

}  // namespace
}  // namespace trochoid
