#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "protocol/units/operator_error.hpp"
#include "server/event/scene.hpp"

namespace trochoid {

namespace fs = std::filesystem;

/// A scene file in a folder of its own that goes with it.
class SceneFile {
public:
    explicit SceneFile(const std::string& text) {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::temp_directory_path() / fmt::format("trochoid-{}-{}-{}", test->name(),
                                                          testing::UnitTest::GetInstance()->random_seed(),
                                                          static_cast<const void*>(this));
        fs::create_directories(folder_);
        std::ofstream(path()) << text;
        std::ofstream(folder_ / "some.terrain") << "x";
    }
    SceneFile(const SceneFile&) = delete;
    SceneFile& operator=(const SceneFile&) = delete;
    ~SceneFile() { fs::remove_all(folder_); }
    fs::path path() const { return folder_ / "scene.toml"; }
    fs::path folder() const { return folder_; }

private:
    fs::path folder_;
};

inline std::string error_of(const std::string& text) {
    const SceneFile file(text);
    try {
        load_scene(file.path());
    } catch (const OperatorError& error) {
        std::string message = error.what();
        const std::string start = file.path().string() + ":";
        EXPECT_EQ(message.rfind(start, 0), 0U) << message << " does not begin with the file's name";
        return message.substr(start.size());
    }
    ADD_FAILURE() << "was accepted:\n" << text;
    return {};
}

struct Complaint {
    std::string from;  ///< text of the good scene that is replaced
    std::string to;
    std::vector<std::string> says;
};

inline void expect_complaints(const std::string& good, const std::vector<Complaint>& complaints) {
    {
        const SceneFile file(good);
        ASSERT_NO_THROW(load_scene(file.path()));
    }
    for (const Complaint& c : complaints) {
        std::string text = good;
        const size_t at = text.find(c.from);
        ASSERT_NE(at, std::string::npos) << c.from;
        text.replace(at, c.from.size(), c.to);
        const std::string message = error_of(text);
        for (const std::string& word : c.says)
            EXPECT_NE(message.find(word), std::string::npos) << message << "\nlacks " << word;
    }
}

}  // namespace trochoid
