// Storms on tracks, ships, irregular heights, noise and breakwaters in scene files.
#include <gtest/gtest.h>

#include "tests/unit/event/scene_file.hpp"

namespace trochoid {
namespace {

constexpr int64_t second = microseconds_per_second;

const std::string storm_text =
    "name = 'test'\n"
    "[[wind]]\n"
    "name = 'storm'\n"
    "speed = 14\n"
    "towards = 90\n"
    "origin = [0, 0]\n"
    "fetch_m = 2000\n"
    "width_m = 500\n"
    "trains = 24\n"
    "begin_s = -10\n"
    "velocity = { towards = 80, speed = 12 }\n"
    "[[wind.leg]]\n"
    "at_s = 600\n"
    "towards = 350\n"
    "speed = 0\n";

const std::string box_text =
    "name = 'test'\n"
    "[[box]]\n"
    "name = 'b'\n"
    "towards = 45\n"
    "origin = [0, 0]\n"
    "length_m = 1000\n"
    "width_m = 500\n"
    "irregular = { share = 0.5 }\n"
    "noise = { amplitude_m = 0.1 }\n"
    "[[box.train]]\n"
    "wavelength_m = 50\n"
    "towards = 50\n"
    "amplitude_m = 0.5\n";

const std::string ship_text =
    "name = 'test'\n"
    "[[ship]]\n"
    "name = 'ferry'\n"
    "at = [10, -20]\n"
    "towards = 359.999999\n"
    "speed = 10\n"
    "begin_s = 5\n"
    "[[ship.leg]]\n"
    "at_s = 60\n"
    "towards = 90\n"
    "speed = 8\n"
    "[[ship.leg]]\n"
    "at_s = 90\n"
    "towards = 90\n"
    "speed = 0\n";

const std::string breakwater_text =
    "name = 'test'\n"
    "terrain = 'some.terrain'\n"
    "[[breakwater]]\n"
    "line = [[0, 0], [100, 0]]\n"
    "width_m = 30\n";

TEST(MovingScene, WindsTakeEveryNewKey) {
    const SceneFile file(
        "name = 'all'\n[[wind]]\nname = 'w'\nspeed = 8.5\ntowards = 270\norigin = [1, -2]\nfetch_m = 4000\nwidth_m = 800\n"
        "trains = 256\ndirections = 8\nspectrum = 'neumann'\nspreading = 'cosine_squared'\nreference_depth_m = 40\n"
        "roundness = 0.5\nirregularity = 0.25\nnoise_m = 0.125\n");
    const StartWind wind = load_scene(file.path()).winds.at(0).wind;
    EXPECT_EQ(wind.trains, 256);
    EXPECT_EQ(wind.directions, 8);
    EXPECT_EQ(wind.spectrum, Spectrum::neumann);
    EXPECT_EQ(wind.spreading, Spreading::cosine_squared);
    EXPECT_EQ(wind.reference_depth, 40.0F);
    EXPECT_EQ(wind.roundness, 0.5F);
    EXPECT_EQ(wind.irregularity, 0.25F);
    EXPECT_EQ(wind.noise, 0.125F);
    EXPECT_EQ(wind.vx, 0.0F);
}

TEST(MovingScene, AStormsTrackIsItsVelocityAndItsLegs) {
    const SceneFile file(storm_text);
    const SceneWind storm = load_scene(file.path()).winds.at(0);
    const std::vector<SceneLeg> legs{{{-10 * second}, 80.0, 12.0}, {{600 * second}, 350.0, 0.0}};
    EXPECT_EQ(storm.legs, legs);
}

TEST(MovingScene, ShipsTakeEveryKey) {
    const SceneFile file(ship_text);
    const SceneShip ship = load_scene(file.path()).ships.at(0);
    EXPECT_EQ(ship.ship, (StartShip{{10240, -20480}, 0.0F, 10.0F, 100.0F, 0.0F, "ferry"}));
    EXPECT_EQ(ship.begin, SeaTime{5 * second});
    const std::vector<SceneLeg> legs{{{60 * second}, 90.0, 8.0}, {{90 * second}, 90.0, 0.0}};
    EXPECT_EQ(ship.legs, legs);
}

TEST(MovingScene, BoxesTakeEveryNewKey) {
    const SceneFile file(
        "name = 'all'\n[[box]]\nname = 'b'\ntowards = 45\norigin = [0, 0]\nlength_m = 1000\nwidth_m = 500\n"
        "reference_depth_m = 12\nroundness = 0.75\nvelocity = { towards = 1, speed = 2 }\n"
        "irregular = { share = 0.5, preset = 'paper', across_m = 3, seed = 11 }\n"
        "noise = { amplitude_m = 0.25, step_m = 4, octaves = 5, persistence = 0.25, period_s = 1, displayed_only = false, seed "
        "= 12 }\n[[box.train]]\nwavelength_m = 50\ntowards = 50\namplitude_m = 0.5\n");
    const SceneBox box = load_scene(file.path()).boxes.at(0);
    EXPECT_EQ(box.reference_depth_m, 12.0);
    EXPECT_EQ(box.roundness, 0.75);
    EXPECT_EQ(box.irregular, (SceneIrregular{SceneIrregular::Form::paper, 0.5, 0.0, 3.0, 11}));
    // 4 m is 2^12 lattice units, 2^20 us the power of two nearest to a second.
    EXPECT_EQ(box.noise, (SurfaceNoise{0.25F, 1 << 14, 5, 12, 20, false, 12}));
    EXPECT_EQ(box.legs, (std::vector<SceneLeg>{{{0}, 1.0, 2.0}}));
}

TEST(MovingScene, RipplesAreAnUnlimitedBoxOfNoise) {
    const SceneFile file("name = 'calm'\n[ripples]\namplitude_m = 0.5\n");
    const SceneBox box = load_scene(file.path()).boxes.at(0);
    EXPECT_EQ(box.name, "ripples");
    EXPECT_EQ(box.length, 0);
    EXPECT_EQ(box.width, 0);
    EXPECT_TRUE(box.trains.empty()) << "noise alone is a box";
    EXPECT_LT(box.begin, SeaTime{-second * 1'000'000'000});
    EXPECT_EQ(box.noise, (SurfaceNoise{0.5F, 1 << 15, 3, 9, 19, true, 1}));
}

TEST(MovingScene, BreakwatersAreChangesOfTheLand) {
    const SceneFile file(breakwater_text);
    EXPECT_EQ(load_scene(file.path()).breakwaters,
              (std::vector<ChangeLand>{{{{0, 0}, {102400, 0}}, 30.0F, 3.0F, false}}));
}

TEST(MovingScene, EveryBadStormIsNamed) {
    expect_complaints(
        storm_text,
        {{"trains = 24", "trains = 24\ndirections = 7", {"10: 'directions' of wind 'storm' is 7", "divisor"}},
         {"trains = 24", "spectrum = 'pierson'", {"9: 'spectrum'", "\"pierson_moskowitz\""}},
         {"trains = 24", "spreading = 3", {"9: 'spreading'", "\"hasselmann\""}},
         {"trains = 24",
          "reference_depth_m = 0.5",
          {"9: 'reference_depth_m'", "0 (deep water) or at least 1 m"}},
         {"trains = 24", "reference_depth_m = 2e4", {"9: 'reference_depth_m'", "0 to 12000 m"}},
         {"trains = 24", "roundness = 1.1", {"9: 'roundness'", "0 to 1"}},
         {"trains = 24", "irregularity = -1", {"9: 'irregularity'", "0 to 1"}},
         {"trains = 24", "noise_m = 2", {"9: 'noise_m'", "0 to 1 m"}},
         {"trains = 24", "noise_m = 1e-9", {"9: 'noise_m'", "at least 1e-6"}},
         {"speed = 12 }",
          "speed = 101 }",
          {"11: 'speed' of velocity of wind 'storm' is 101", "0 to 100 m/s"}},
         {"speed = 12 }", "speed = 12, at = 3 }", {"11: unknown key 'at'"}},
         {"{ towards = 80, speed = 12 }", "12", {"11: 'velocity'", "is not a table"}},
         {"at_s = 600", "at_s = -10", {"13: 'at_s' of leg 1 of wind 'storm'", "in order of time"}},
         {"at_s = 600", "at_s = nan", {"13: 'at_s'"}},
         {"towards = 350", "towards = 360", {"14: 'towards' of leg 1 of wind 'storm'"}},
         {"speed = 0\n", "", {"12: 'speed' of leg 1", "is missing"}},
         {"name = 'storm'", "name = 'ripples'", {"3: 'name'", "is taken"}}});
}

TEST(MovingScene, EveryBadIrregularityAndNoiseIsNamed) {
    expect_complaints(
        box_text,
        {{"share = 0.5", "share = 1.5", {"8: 'share' of irregular of box 'b'", "0 to 1"}},
         {"share = 0.5", "along_m = 50", {"'share' of irregular of box 'b' is missing"}},
         {"share = 0.5", "share = 0.5, along_m = 0.5", {"8: 'along_m'", "1 to 100000 m"}},
         {"share = 0.5", "share = 0.5, preset = 'waves'", {"8: 'preset'", "\"groups\" or \"paper\""}},
         {"share = 0.5", "share = 0.5, preset = 'paper', along_m = 5", {"8: 'along_m'", "leave it out"}},
         {"amplitude_m = 0.1", "amplitude_m = 0", {"9: 'amplitude_m' of noise of box 'b'"}},
         {"amplitude_m = 0.1", "amplitude_m = 0.1, step_m = 3", {"9: 'step_m'", "a power of two"}},
         {"amplitude_m = 0.1", "amplitude_m = 0.1, octaves = 13", {"9: 'octaves'", "1 to 12"}},
         {"amplitude_m = 0.1", "amplitude_m = 0.1, octaves = 7", {"9: 'octaves'", "give 1 to 6"}},
         {"amplitude_m = 0.1",
          "amplitude_m = 0.1, step_m = 64, period_s = 0.02, octaves = 4",
          {"9: 'octaves'", "give 1 to 3"}},
         {"amplitude_m = 0.1", "amplitude_m = 0.1, persistence = 2", {"9: 'persistence'", "0 to 1"}},
         {"amplitude_m = 0.1", "amplitude_m = 0.1, displayed_only = 1", {"9: 'displayed_only'", "true"}},
         {"width_m = 500", "width_m = 0\nroundness = 0.5", {"8: 'roundness'", "limited width"}},
         {"length_m = 1000\nwidth_m = 500",
          "length_m = 0\nwidth_m = 0\nvelocity = { towards = 1, speed = 2 }",
          {"8: 'velocity'", "limited side"}},
         {"[[box.train]]\nwavelength_m = 50\ntowards = 50\namplitude_m = 0.5\n",
          "",
          {"8: 'irregular'", "needs trains"}}});
}

TEST(MovingScene, EveryBadShipIsNamed) {
    expect_complaints(
        ship_text,
        {{"at = [10, -20]", "origin = [10, -20]", {"'at' of ship 'ferry' is missing"}},
         {"speed = 10", "speed = 0", {"6: 'speed' of ship 'ferry' is 0", "0.5 to 30 m/s"}},
         {"speed = 10", "speed = 10\nlength_m = 501", {"7: 'length_m'", "1 to 500 m"}},
         {"speed = 10", "speed = 10\nlength_m = 20\nbeam_m = 21", {"8: 'beam_m'", "0 to 20 m"}},
         {"speed = 8", "speed = 0", {"8: 'leg' of ship 'ferry' number 1 has the speed 0", "in the last"}},
         {"speed = 8", "speed = 31", {"'speed' of leg 1 of ship 'ferry'", "0 to 30 m/s"}},
         {"at_s = 60", "at_s = 5", {"'at_s' of leg 1 of ship 'ferry'", "in order"}},
         {"begin_s = 5", "velocity = { towards = 1, speed = 2 }", {"unknown key 'velocity'"}}});
}

TEST(MovingScene, EveryBadBreakwaterIsNamed) {
    expect_complaints(
        breakwater_text,
        {{"terrain = 'some.terrain'\n", "", {"'breakwater'", "needs a terrain"}},
         {"[[0, 0], [100, 0]]", "[[0, 0]]", {"4: 'line' of breakwater 1 has 1 places", "2 to 64"}},
         {"[[0, 0], [100, 0]]", "[[0, 0], [1e9, 0]]", {"4: 'line'", "number 2", "33554432"}},
         {"[[0, 0], [100, 0]]", "[0, 0]", {"4: 'line'", "number 1"}},
         {"[[0, 0], [100, 0]]", "'here'", {"4: 'line'", "is not a list"}},
         {"width_m = 30", "width_m = 0", {"5: 'width_m'", "1 to 2000 m"}},
         {"width_m = 30", "crest_m = 201", {"5: 'crest_m'", "-200 to 200 m"}},
         {"width_m = 30", "dig = 'yes'", {"5: 'dig'", "true nor false"}},
         {"width_m = 30", "depth_m = 3", {"5: unknown key 'depth_m'"}}});
}

}  // namespace
}  // namespace trochoid
