// The examples of scene-reference.md are scenes that load, and together they use every key that its tables name.
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>

#include "tests/unit/event/scene_file.hpp"

namespace trochoid {
namespace {

std::string reference() {
    std::ifstream in(fs::path(TROCHOID_SOURCE_DIR) / "server" / "event" / "scene-reference.md");
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

std::vector<std::string> examples() {
    std::vector<std::string> list;
    const std::string text = reference();
    const std::string fence = "```toml\n";
    for (size_t at = text.find(fence); at != std::string::npos; at = text.find(fence, at)) {
        at += fence.size();
        list.push_back(text.substr(at, text.find("```", at) - at));
    }
    return list;
}

/// Words in backticks in the first column of every table.
std::set<std::string> documented_keys() {
    std::set<std::string> keys;
    std::istringstream text(reference());
    const std::regex word("`(?:\\[+)?([a-z_.]+)(?:\\]+)?`");
    for (std::string line; std::getline(text, line);) {
        if (line.rfind("| `", 0) != 0) continue;
        const std::string column = line.substr(2, line.find(" | ", 2) - 2);
        for (auto i = std::sregex_iterator(column.begin(), column.end(), word); i != std::sregex_iterator();
             ++i)
            keys.insert((*i)[1]);
    }
    return keys;
}

TEST(SceneReference, EveryExampleLoads) {
    const auto all = examples();
    EXPECT_GE(all.size(), 6U);
    for (const std::string& example : all) {
        const SceneFile file(example);
        EXPECT_NO_THROW({
            try {
                load_scene(file.path());
            } catch (const OperatorError& error) {
                ADD_FAILURE() << error.what() << "\n" << example;
                throw;
            }
        });
    }
}

TEST(SceneReference, TheExamplesUseEveryKeyOfTheTables) {
    std::string all;
    for (const std::string& example : examples()) all += example;
    const auto keys = documented_keys();
    EXPECT_GT(keys.size(), 60U);
    for (const std::string& key : keys) {
        const std::regex used("(^|[\\n{ ])(\\[\\[" + key + "\\]\\]|" + key + " = )");
        EXPECT_TRUE(std::regex_search(all, used)) << key;
    }
}

}  // namespace
}  // namespace trochoid
