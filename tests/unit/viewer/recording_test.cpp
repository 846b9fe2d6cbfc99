// Recordings: folders, videos where ffmpeg is, and disks that are full.
#include "client/app/recording.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "protocol/units/operator_error.hpp"

namespace trochoid {
namespace {

namespace fs = std::filesystem;

class Recordings : public ::testing::Test {
protected:
    Recordings() {
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    ~Recordings() override { fs::remove_all(folder); }
    const fs::path folder = fs::temp_directory_path() / "trochoid-test-recordings";
    const Picture picture{34, 18, std::vector<uint8_t>(size_t{34} * 18 * 3, 90)};
};

std::string refusal(const std::string& where) {
    try {
        open_recording(where, 30);
    } catch (const OperatorError& error) {
        return error.what();
    }
    ADD_FAILURE() << where << " was taken";
    return {};
}

TEST_F(Recordings, number_their_pictures_in_a_new_folder) {
    const fs::path where = folder / "new" / "deep";
    Recording recording(where.string(), 30, true);
    for (int i = 0; i < 3; ++i) recording.add(picture, 0);
    recording.finish();
    EXPECT_EQ(recording.pictures(), 3U);
    EXPECT_TRUE(fs::exists(where / "frame_000000.png"));
    EXPECT_TRUE(fs::exists(where / "frame_000002.png"));
    EXPECT_FALSE(fs::exists(where / "frame_000003.png"));
}

TEST_F(Recordings, keep_their_rate_when_frames_are_slow_or_fast) {
    Recording recording((folder / "rate").string(), 10, false);
    recording.add(picture, 0.0);
    EXPECT_EQ(recording.wanted_at(0.05), 0U) << "a fast frame is left out";
    recording.add(picture, 0.05);
    EXPECT_EQ(recording.pictures(), 1U);
    recording.add(picture, 0.51);
    EXPECT_EQ(recording.pictures(), 6U) << "a slow one is repeated";
}

TEST_F(Recordings, refuse_to_write_over_anything) {
    std::ofstream(folder / "file") << "x";
    EXPECT_NE(refusal(folder.string()).find("not empty"), std::string::npos);
    EXPECT_NE(refusal((folder / "file").string()).find("is a file"), std::string::npos);
    std::ofstream(folder / "old.mp4") << "x";
    EXPECT_NE(refusal((folder / "old.mp4").string()).find("exists"), std::string::npos);
    EXPECT_NE(refusal("/proc/nowhere/there").find("cannot be made"), std::string::npos);
}

TEST_F(Recordings, know_videos_by_their_ending) {
    EXPECT_TRUE(is_video("a.mp4"));
    EXPECT_TRUE(is_video("b/c.mkv"));
    EXPECT_TRUE(is_video("c.webm"));
    EXPECT_FALSE(is_video("frames"));
    EXPECT_FALSE(is_video("mp4"));
}

TEST_F(Recordings, say_what_to_do_without_ffmpeg) {
    const char* path = std::getenv("PATH");
    const std::string old = path != nullptr ? path : "";
    setenv("PATH", folder.c_str(), 1);
    Recording recording((folder / "sea.mp4").string(), 30, true);
    try {
        recording.add(picture, 0);
        ADD_FAILURE() << "there is no ffmpeg in an empty folder";
    } catch (const OperatorError& error) {
        EXPECT_NE(std::string(error.what()).find("apt install ffmpeg"), std::string::npos) << error.what();
    }
    setenv("PATH", old.c_str(), 1);
}

/// A program named ffmpeg that does what a script says, in place of the real one.
class FakeFfmpeg {
public:
    FakeFfmpeg(const fs::path& folder, const std::string& script) {
        const fs::path program = folder / "bin" / "ffmpeg";
        fs::create_directories(program.parent_path());
        std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
        fs::permissions(program, fs::perms::owner_all);
        const char* path = std::getenv("PATH");
        old_ = path != nullptr ? path : "";
        setenv("PATH", (program.parent_path().string() + ":" + old_).c_str(), 1);
    }
    FakeFfmpeg(const FakeFfmpeg&) = delete;
    FakeFfmpeg& operator=(const FakeFfmpeg&) = delete;
    ~FakeFfmpeg() { setenv("PATH", old_.c_str(), 1); }

private:
    std::string old_;
};

TEST_F(Recordings, hand_ffmpeg_every_byte_and_the_size) {
    const FakeFfmpeg fake(
        folder, "echo \"$@\" > " + (folder / "words").string() + "; cat > " + (folder / "bytes").string());
    Recording recording((folder / "it's here.mkv").string(), 25, true);
    for (int i = 0; i < 4; ++i) recording.add(picture, 0);
    recording.finish();
    EXPECT_EQ(fs::file_size(folder / "bytes"), 4 * picture.rgb.size());
    std::ifstream file(folder / "words");
    const std::string words((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    for (const char* part : {"34x18", "-framerate 25", "rgb24", "it's here.mkv"})
        EXPECT_NE(words.find(part), std::string::npos) << part << " is missing in " << words;
}

TEST_F(Recordings, notice_an_ffmpeg_that_fails) {
    {
        const FakeFfmpeg fake(folder, "cat > /dev/null; exit 7");
        Recording recording((folder / "late.mp4").string(), 25, true);
        recording.add(picture, 0);
        EXPECT_THROW(recording.finish(), OperatorError);
    }
    const FakeFfmpeg fake(folder, "exit 1");
    Recording recording((folder / "early.mp4").string(), 25, true);
    const Picture large{640, 360, std::vector<uint8_t>(size_t{640} * 360 * 3)};
    EXPECT_THROW(
        {
            for (int i = 0; i < 20; ++i) recording.add(large, 0);
        },
        OperatorError);
}

TEST_F(Recordings, keep_a_videos_size) {
    const FakeFfmpeg fake(folder, "cat > /dev/null");
    Recording recording((folder / "size.mp4").string(), 25, true);
    recording.add(picture, 0);
    const Picture other{20, 20, std::vector<uint8_t>(1200)};
    EXPECT_THROW(recording.add(other, 0), OperatorError);
}

TEST_F(Recordings, get_names_that_are_free) {
    const fs::path before = fs::current_path();
    fs::current_path(folder);
    const std::string first = stamped_name(1'700'000'000, ".png");
    EXPECT_EQ(first.size(), std::string("trochoid-20231114-221320.png").size());
    std::ofstream(first) << "x";
    const std::string second = stamped_name(1'700'000'000, ".png");
    EXPECT_NE(first, second);
    EXPECT_TRUE(second.ends_with("-2.png"));
    fs::current_path(before);
}

}  // namespace
}  // namespace trochoid
