// What a window keeps: written whole, read back, and never lost where the file is not ours.
#include "client/app/viewer_settings.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "protocol/units/operator_error.hpp"
#include "tests/unit/viewer/parsed.hpp"

namespace trochoid {
namespace {

namespace fs = std::filesystem;

class Settings : public ::testing::Test {
protected:
    Settings() { fs::remove_all(folder); }
    ~Settings() override { fs::remove_all(folder); }
    void write(const std::string& text) const {
        fs::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary) << text;
    }
    std::string text() const {
        std::ifstream stream(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    }
    const fs::path folder = fs::temp_directory_path() / "trochoid-test-settings";
    const fs::path file = folder / "deeper" / "viewer.toml";
};

TEST_F(Settings, come_back_as_they_were) {
    ViewerSettings s;
    s.width = 801;
    s.height = 450;
    s.full_screen = s.numbers = true;
    s.quality = Quality::high;
    s.mesher = MesherKind::coherent;
    s.far_method = FarMethod::texture;
    s.refinement = Refinement::frustum;
    s.target_ms = 16.6;
    save_settings(file, s);
    const KeptSettings kept = load_settings(file);
    EXPECT_EQ(kept.values, s);
    EXPECT_EQ(kept.complaint, "");
    save_settings(file, ViewerSettings{});
    EXPECT_EQ(load_settings(file).values, ViewerSettings{}) << "a second time, over the first";
    EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), {}), 1)
        << "nothing is left beside it";
}

/// What a window leaves, the command line takes.
TEST_F(Settings, sizes_are_those_of_the_options) {
    for (const uint32_t length : {15U, 16U, 16'384U, 16'385U}) {
        write("width = " + std::to_string(length) + "\n");
        bool taken = true;
        try {
            parsed({"--size=" + std::to_string(length) + "x16"});
        } catch (const OperatorError&) {
            taken = false;
        }
        EXPECT_EQ(load_settings(file).complaint.empty(), taken) << length;
    }
}

TEST_F(Settings, none_is_no_complaint) {
    EXPECT_EQ(load_settings(file).complaint, "");
    EXPECT_EQ(load_settings({}).complaint, "");
    EXPECT_NO_THROW(save_settings({}, {}));
}

TEST_F(Settings, a_broken_file_is_told_with_its_line_and_stays) {
    const std::string broken = "width = 900\nheight = = 3\n";
    write(broken);
    const KeptSettings kept = load_settings(file);
    EXPECT_EQ(kept.values, ViewerSettings{});
    EXPECT_NE(kept.complaint.find("line 2"), std::string::npos) << kept.complaint;
    EXPECT_NE(kept.complaint.find(file.string()), std::string::npos);
    EXPECT_EQ(text(), broken);
}

TEST_F(Settings, a_value_that_makes_no_sense_leaves_the_others) {
    write(
        "width = 900\nheight = 3\nmesher = \"knitting\"\nquality = 7\ntarget_ms = -2\nfull_screen = \"yes\"\nnumbers = true\n");
    const KeptSettings kept = load_settings(file);
    EXPECT_EQ(kept.values.width, 900U);
    EXPECT_EQ(kept.values.height, ViewerSettings{}.height);
    EXPECT_EQ(kept.values.mesher, MesherKind::patches);
    EXPECT_TRUE(kept.values.numbers);
    for (const char* key : {"height", "mesher", "quality", "target_ms", "full_screen",
                            "patches, uniform, projected or coherent"})
        EXPECT_NE(kept.complaint.find(key), std::string::npos) << key;
}

TEST_F(Settings, a_folder_in_the_way_is_an_error_that_says_so) {
    fs::create_directories(file);
    std::ofstream(file / "inside") << "x";
    try {
        save_settings(file, {});
        FAIL();
    } catch (const OperatorError& error) {
        EXPECT_NE(std::string(error.what()).find("--no-settings"), std::string::npos);
    }
    EXPECT_FALSE(load_settings(file).complaint.empty());
}

TEST(SettingsFile, lies_where_the_desktop_keeps_such) {
    const char* home = std::getenv("HOME");
    const std::string old_home = home != nullptr ? home : "";
    const char* config = std::getenv("XDG_CONFIG_HOME");
    const std::string old_config = config != nullptr ? config : "";
    setenv("HOME", "/home/somebody", 1);
    setenv("XDG_CONFIG_HOME", "/elsewhere", 1);
    EXPECT_EQ(settings_file(), "/elsewhere/trochoid/viewer.toml");
    setenv("XDG_CONFIG_HOME", "not/absolute", 1);
    EXPECT_EQ(settings_file(), "/home/somebody/.config/trochoid/viewer.toml");
    unsetenv("XDG_CONFIG_HOME");
    EXPECT_EQ(settings_file(), "/home/somebody/.config/trochoid/viewer.toml");
    unsetenv("HOME");
    EXPECT_EQ(settings_file(), "");
    setenv("HOME", old_home.c_str(), 1);
    if (config != nullptr) setenv("XDG_CONFIG_HOME", old_config.c_str(), 1);
}

}  // namespace
}  // namespace trochoid
