#include "server/event/scene.hpp"

#include <gtest/gtest.h>

#include "protocol/units/operator_error.hpp"
#include "tests/unit/event/scene_file.hpp"

namespace trochoid {
namespace {

const std::string wind_text =
    "name = 'test'\n"
    "[[wind]]\n"
    "name = 'west'\n"
    "speed = 14\n"
    "towards = 90.5\n"
    "origin = [-1000.5, 250]\n"
    "fetch_m = 2000\n"
    "width_m = 500\n";

const std::string box_text =
    "name = 'test'\n"
    "[[box]]\n"
    "name = 'b'\n"
    "towards = 45\n"
    "origin = [0, 0]\n"
    "length_m = 1000\n"
    "width_m = 0\n"
    "[[box.train]]\n"
    "wavelength_m = 50\n"
    "towards = 50\n"
    "amplitude_m = 0.5\n";

TEST(Scene, ReadsEveryKey) {
    const SceneFile file(
        "name = 'all'\n"
        "terrain = 'some.terrain'\n"
        "[clock]\nstart_s = 12.5\nrate = 2.5\n"
        "[land]\nnode_step_m = 128\nrefraction = 'straight'\nshoaling = 'paper'\nrecovery_m = 900\n"
        "depth_min_m = 2\nbreaking_ratio = 0\nspread = 0.1\nrun_up_m = 1.5\nshore_decrease = 0.5\n"
        "diffraction = 'parabolic'\nshallow_orbits = true\n"
        "[[wind]]\nname = 'w'\nspeed = 8.5\ntowards = 270\norigin = [1, -2]\nfetch_m = 4000\nwidth_m = 800\n"
        "life_s = 600\nbegin_s = -1800\ntrains = 24\nseed = 99\n"
        "[[box]]\nname = 'b'\ntowards = 10\norigin = [3.5, 4]\nlength_m = 700\nwidth_m = 300\nramp_rear_m = 20\n"
        "ramp_front_m = 30\nramp_side_m = 40\nbegin_s = 5\nbuild_up_s = 6\nlife_s = 7\ndecay_s = 8\nfront_speed = 9\n"
        "[[box.train]]\nwavelength_m = 60\ntowards = 11\namplitude_m = 1\nphase_turns = 0.25\nchoppiness = 0.5\n"
        "[[box.train]]\nwavelength_m = 30\ntowards = 12\namplitude_m = 2\n");
    const Scene scene = load_scene(file.path());
    EXPECT_EQ(scene.name, "all");
    EXPECT_EQ(scene.terrain, file.folder() / "some.terrain");
    EXPECT_EQ(scene.clock_start, SeaTime{12'500'000});
    EXPECT_EQ(scene.rate_q16, 5U << 15);
    const SceneLand land{17,
                         SceneLand::Refraction::straight,
                         SceneLand::Shoaling::paper,
                         2.0,
                         0.0,
                         900.0,
                         0.1,
                         1.5,
                         0.5,
                         SceneLand::Diffraction::parabolic,
                         true};
    EXPECT_EQ(scene.land, land);
    ASSERT_EQ(scene.winds.size(), 1U);
    const StartWind wind{8.5F, 270.0F, {1024, -2048}, 4000 * 1024, 800 * 1024, 600'000'000, 24, 99};
    EXPECT_EQ(scene.winds[0], (SceneWind{"w", wind, {-1'800'000'000}, {}}));
    ASSERT_EQ(scene.boxes.size(), 1U);
    const SceneBox box{"b",          10.0,
                       {3584, 4096}, 700 * 1024,
                       300 * 1024,   20 * 1024,
                       30 * 1024,    40 * 1024,
                       {5'000'000},  6'000'000,
                       7'000'000,    8'000'000,
                       9.0,          {{60.0, 11.0, 1.0, 0.25, 0.5}, {30.0, 12.0, 2.0, 0.0, 1.0}}};
    EXPECT_EQ(scene.boxes[0], box);
}

TEST(Scene, DefaultsAreThoseOfTheReference) {
    const SceneFile file(wind_text);
    const Scene scene = load_scene(file.path());
    EXPECT_TRUE(scene.terrain.empty());
    EXPECT_EQ(scene.clock_start, SeaTime{0});
    EXPECT_EQ(scene.rate_q16, 1U << 16);
    EXPECT_EQ(scene.land, SceneLand{});
    EXPECT_EQ(scene.winds.at(0).wind.trains, 16);
    EXPECT_EQ(scene.winds.at(0).wind.life_us, 0);
    EXPECT_EQ(scene.winds.at(0).begin, SeaTime{0});
    EXPECT_EQ(scene.winds.at(0).wind.origin, (LatticePoint{-1024512, 256000}));
}

TEST(Scene, FilesThatCannotBeReadSayWhatToDo) {
    for (const char* path : {"/nonexistent/scene.toml", "/"}) {
        try {
            load_scene(path);
            ADD_FAILURE() << path << " was read";
        } catch (const OperatorError& error) {
            EXPECT_NE(std::string(error.what()).find(path), std::string::npos);
            EXPECT_NE(std::string(error.what()).find("check the path"), std::string::npos) << error.what();
        }
    }
    EXPECT_NE(error_of("name = \n").find("1: not TOML"), std::string::npos);
    EXPECT_NE(error_of("name = 'a'\nname = 'b'\n").find("2: not TOML"), std::string::npos);
    EXPECT_NE(error_of(std::string("name = '\xff\xfe'\n")).find("1: not TOML"), std::string::npos);
    EXPECT_NE(error_of(std::string(2U << 20, ' ')).find("at most"), std::string::npos);
}

TEST(Scene, EveryBadWindIsNamedByLineKeyAndRange) {
    expect_complaints(
        wind_text,
        {{"name = 'test'\n", "\n", {"'name' is missing", "1 to 64 bytes"}},
         {"'test'", "''", {"1: 'name' is a text of 0 bytes", "1 to 64"}},
         {"'test'", "3", {"1: 'name' is not a text"}},
         {"'test'", "\"a\\u0007\"", {"1: 'name' holds a control character"}},
         {"name = 'test'\n", "name = 'test'\nwnd = 3\n", {"2: unknown key 'wnd'", "wind"}},
         {"name = 'test'\n",
          "name = 'test'\nterrain = 'no.terrain'\n",
          {"2: 'terrain'", "no.terrain", "trochoid-import"}},
         {"[[wind]]", "[wind]", {"2: 'wind' is not a list of tables", "[[wind]]"}},
         {"speed = 14", "speed = 0.5", {"4: 'speed' of wind 'west' is 0.5", "1 to 40 m/s"}},
         {"speed = 14", "speed = nan", {"4: 'speed'", "1 to 40 m/s"}},
         {"speed = 14", "speed = '14'", {"4: 'speed'", "is not a number", "1 to 40 m/s"}},
         {"speed = 14\n", "", {"2: 'speed' of wind 'west' is missing", "1 to 40 m/s"}},
         {"towards = 90.5", "towards = 360", {"5: 'towards'", "is 360", "0 to 359.999999 degrees"}},
         {"towards = 90.5", "towards = -1", {"5: 'towards'", "is -1"}},
         {"[-1000.5, 250]", "[1, 2, 3]", {"6: 'origin'", "is not a pair", "metres east and south"}},
         {"[-1000.5, 250]", "[1, 4e7]", {"6: 'origin'", "33554432"}},
         {"[-1000.5, 250]", "5", {"6: 'origin'", "is not a pair"}},
         {"fetch_m = 2000", "fetch_m = 31", {"7: 'fetch_m'", "32 to 1048576 m"}},
         {"width_m = 500", "width_m = 2e6", {"8: 'width_m'", "32 to 1048576 m"}},
         {"width_m = 500", "width_m = 500\nlife_s = 0.5", {"9: 'life_s'", "at least 1 s"}},
         {"width_m = 500", "width_m = 500\nlife_s = -1", {"9: 'life_s'", "is -1"}},
         {"width_m = 500", "width_m = 500\nbegin_s = 1e12", {"9: 'begin_s'", "3.2e+10 s"}},
         {"width_m = 500", "width_m = 500\ntrains = 257", {"9: 'trains'", "is 257", "1 to 256"}},
         {"width_m = 500", "width_m = 500\ntrains = 1.5", {"9: 'trains'", "not a whole number"}},
         {"width_m = 500", "width_m = 500\nseed = 0", {"9: 'seed'", "is 0"}},
         {"width_m = 500", "width_m = 500\nfetch = 3", {"9: unknown key 'fetch' of wind 'west'", "fetch_m"}},
         {"width_m = 500", "width_m = 500\n[[wind]]\nname = 'west'", {"10: 'name'", "is taken"}}});
}

TEST(Scene, EveryBadClockAndLandIsNamed) {
    expect_complaints(
        "name = 'test'\n[clock]\nrate = 1\n[land]\nnode_step_m = 64\nrefraction = 'eikonal'\nshoaling = 'linear'\nrecovery_m = 10\n",
        {{"rate = 1", "rate = 17", {"3: 'rate' of [clock] is 17", "0 to 16"}},
         {"rate = 1", "start_s = 'now'", {"3: 'start_s'", "not a number"}},
         {"rate = 1", "speed = 1", {"3: unknown key 'speed' of [clock]", "rate, start_s"}},
         {"[clock]\nrate = 1", "clock = 4", {"2: 'clock' is not a table", "[clock]"}},
         {"= 64", "= 48", {"5: 'node_step_m' of [land] is 48", "power of two"}},
         {"= 64", "= 2", {"5: 'node_step_m'", "4 to 256"}},
         {"'eikonal'",
          "'snell'",
          {"6: 'refraction'", "\"snell\"", "\"none\" or \"phase_shift\" or \"straight\" or \"eikonal\""}},
         {"'linear'", "true", {"7: 'shoaling'", "\"paper\" or \"linear\" or \"decrease\" or \"none\""}},
         {"recovery_m = 10", "recovery_m = 0", {"8: 'recovery_m'", "1 to 100000 m"}},
         {"recovery_m = 10", "breaking_ratio = 0.05", {"8: 'breaking_ratio'", "0.1 to 2"}},
         {"recovery_m = 10", "spread = 1", {"8: 'spread'", "0 to 0.5"}},
         {"recovery_m = 10", "run_up_m = 11", {"8: 'run_up_m'", "0 to 10 m"}},
         {"recovery_m = 10", "shore_decrease = 2", {"8: 'shore_decrease'", "0 to 1"}},
         {"recovery_m = 10", "shallow_orbits = 1", {"8: 'shallow_orbits'", "true"}},
         {"recovery_m = 10",
          "diffraction = true",
          {"8: 'diffraction'", "\"none\" or \"wedge\" or \"parabolic\""}},
         {"recovery_m = 10", "depth_min_m = 0", {"8: 'depth_min_m'", "0.1 to 100 m"}}});
}

TEST(Scene, EveryBadBoxIsNamed) {
    std::string many;
    for (int i = 0; i < 256; ++i)
        many += "[[box.train]]\nwavelength_m = 50\ntowards = 50\namplitude_m = 0.01\n";
    expect_complaints(
        box_text,
        {{"name = 'b'\n", "", {"2: 'name' of a box is missing"}},
         {"length_m = 1000", "length_m = 99", {"6: 'length_m' of box 'b'", "shorter than the ramps"}},
         {"width_m = 0", "width_m = 60", {"7: 'width_m'", "narrower"}},
         {"width_m = 0", "width_m = 0\nramp_side_m = 0.5", {"8: 'ramp_side_m'", "1 to 1048576 m"}},
         {"width_m = 0", "width_m = 0\nbuild_up_s = 6e5", {"8: 'build_up_s'"}},
         {"length_m = 1000", "length_m = 0\nfront_speed = 3", {"7: 'front_speed'", "limited length"}},
         {"wavelength_m = 50",
          "wavelength_m = 0.04",
          {"9: 'wavelength_m' of train 1 of box 'b'", "0.05 to 4000 m"}},
         {"amplitude_m = 0.5", "amplitude_m = 0", {"11: 'amplitude_m'"}},
         {"amplitude_m = 0.5", "amplitude_m = 0.5\nphase_turns = 1", {"12: 'phase_turns'"}},
         {"amplitude_m = 0.5", "amplitude_m = 0.5\nchoppiness = 4.5", {"12: 'choppiness'", "0 to 4"}},
         {"amplitude_m = 0.5", "amplitude_m = 0.5\nphase = 0.5", {"12: unknown key 'phase'"}},
         {"amplitude_m = 0.5\n",
          "amplitude_m = 0.5\n" + many,
          {"'train' of box 'b' is there 257 times", "1 to 256"}},
         {"[[box.train]]\nwavelength_m = 50\ntowards = 50\namplitude_m = 0.5\n",
          "",
          {"2: 'train' of box 'b'", "0 times"}}});
}

TEST(Scene, ShippedScenesLoad) {
    const fs::path scenes = fs::path(TROCHOID_SOURCE_DIR) / "server" / "scenes";
    const Scene scilly = load_scene(scenes / "scilly" / "scene.toml");
    EXPECT_FALSE(scilly.terrain.empty());
    EXPECT_EQ(scilly.winds.size(), 2U);
    const Scene open_sea = load_scene(scenes / "open-sea" / "scene.toml");
    EXPECT_TRUE(open_sea.terrain.empty());
    EXPECT_EQ(open_sea.winds.size(), 2U);
}

}  // namespace
}  // namespace trochoid
