// viewer-reference.md, --help and the keys say the same; the reference's examples are understood.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

#include "client/gpu/key_bindings.hpp"
#include "client/scene/presets.hpp"
#include "tests/unit/viewer/parsed.hpp"

namespace trochoid {
namespace {

std::string text_of(const std::string& name) {
    std::ifstream file(std::string(TROCHOID_SOURCE_DIR) + "/" + name);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string reference() { return text_of("client/app/viewer-reference.md"); }

std::set<std::string> found(const std::string& text, const std::regex& pattern) {
    std::set<std::string> all;
    for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it)
        all.insert((*it)[1].str());
    return all;
}

TEST(Reference, has_the_options_of_the_help_and_no_others) {
    // In the help an option begins its line; in the reference it begins a row of a table, or stands by itself.
    const std::set<std::string> helped =
        found(viewer_help(), std::regex("(?:^|\\n)  (?:-[a-z],)?(--[a-z-]+)"));
    const std::set<std::string> told = found(reference(), std::regex("\\n(?:\\| )?`(--[a-z-]+)"));
    ASSERT_GT(helped.size(), 40U);
    for (const std::string& option : helped) {
        if (option == "--help" || option == "--version") continue;
        EXPECT_TRUE(told.contains(option)) << option << " is in --help, not in viewer-reference.md";
    }
    for (const std::string& option : told)
        EXPECT_TRUE(helped.contains(option)) << option << " is in viewer-reference.md only";
}

/// demo.sh refuses a preset before it builds anything, so it has to know them.
TEST(Reference, the_demo_knows_the_presets) {
    std::string names;
    for (const Preset& preset : presets()) names += (names.empty() ? "" : " ") + std::string(preset.name);
    EXPECT_NE(text_of("demo.sh").find("\npresets='" + names + "'\n"), std::string::npos) << names;
    const std::string command = "TROCHOID_SKIP_DEPENDENCIES=1 timeout 20 bash " TROCHOID_SOURCE_DIR
                                "/demo.sh --offscreen --preset nonsense 2>&1; echo status $?";
    FILE* demo = popen(command.c_str(), "r");
    ASSERT_NE(demo, nullptr);
    std::string said;
    for (int c = std::fgetc(demo); c != EOF; c = std::fgetc(demo)) said += static_cast<char>(c);
    pclose(demo);
    EXPECT_EQ(said, "demo.sh: --preset nonsense: there are calm, breeze, gale, storm, harbour\nstatus 2\n");
}

TEST(Reference, has_every_key) {
    const std::string text = reference();
    const std::string help = viewer_help();
    for (const KeyBinding& binding : key_bindings()) {
        if (binding.shown.empty()) continue;
        const std::string row = "| `" + std::string(binding.shown) + "` |";
        EXPECT_NE(text.find(row), std::string::npos) << "viewer-reference.md has no row " << row;
        EXPECT_NE(help.find(std::string(binding.about)), std::string::npos)
            << "--help has no " << binding.about;
    }
}

TEST(Reference, has_every_setting) {
    const std::string text = reference();
    for (const char* key :
         {"width", "height", "full_screen", "numbers", "quality", "mesher", "far", "refine", "target_ms"})
        EXPECT_NE(text.find("`" + std::string(key) + "`"), std::string::npos) << key;
}

/// Words of the lines that start the viewer, in sh blocks; without quotes, which none needs.
std::vector<std::vector<std::string>> examples(const std::string& text, const std::string& program) {
    std::vector<std::vector<std::string>> all;
    std::istringstream lines(text);
    bool in_block = false;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("```")) in_block = line == "```sh";
        if (!in_block || !line.starts_with(program)) continue;
        std::istringstream words(line.substr(0, line.find(" #")));
        all.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
        all.back().erase(all.back().begin());
    }
    return all;
}

TEST(Reference, has_examples_that_work) {
    const auto all = examples(reference(), "trochoid-viewer");
    ASSERT_GE(all.size(), 8U);
    for (const auto& words : all) {
        std::string line;
        for (const std::string& word : words) line += word + " ";
        EXPECT_NO_THROW(parsed(words)) << line;
    }
}

TEST(Readme, hands_the_viewer_only_what_it_knows) {
    for (std::vector<std::string> words : examples(text_of("README.md"), "./demo.sh")) {
        const auto rest = std::find(words.begin(), words.end(), "--");
        if (rest == words.end()) continue;
        EXPECT_NO_THROW(parsed({rest + 1, words.end()}));
    }
}

}  // namespace
}  // namespace trochoid
