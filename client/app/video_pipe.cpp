#include "client/app/video_pipe.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <utility>
#include <vector>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

std::vector<std::string> command_of(const std::string& file, double rate, uint32_t width, uint32_t height) {
    std::vector<std::string> words{
        "ffmpeg", "-hide_banner", "-loglevel", "error", "-n", "-f", "rawvideo", "-pix_fmt", "rgb24",
        "-video_size", fmt::format("{}x{}", width, height), "-framerate", fmt::format("{}", rate), "-i",
        "pipe:0",
        // Half the colours' resolution, as every player wants it, which takes even sizes.
        "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"};
    const auto add = [&words](std::initializer_list<const char*> more) {
        words.insert(words.end(), more.begin(), more.end());
    };
    if (file.ends_with(".webm"))
        add({"-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-deadline", "realtime", "-cpu-used", "5"});
    else
        add({"-c:v", "libx264", "-crf", "18", "-preset", "veryfast"});
    if (file.ends_with(".mp4")) add({"-movflags", "+faststart"});
    // "file:" keeps names such as "-x.mp4" or "a:b.mp4" what they are.
    words.push_back("file:" + file);
    return words;
}

/// What posix_spawn is told of a child's files and process group.
class SpawnPlan {
public:
    explicit SpawnPlan(int input) {
        posix_spawn_file_actions_init(&files);
        posix_spawnattr_init(&attributes);
        posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 34)
        // Neither our sockets nor our windows are its business.
        posix_spawn_file_actions_addclosefrom_np(&files, 3);
#endif
        // A group of its own: Ctrl-C ends the viewer, which then ends the video in order.
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
        posix_spawnattr_setpgroup(&attributes, 0);
    }
    SpawnPlan(const SpawnPlan&) = delete;
    SpawnPlan& operator=(const SpawnPlan&) = delete;
    ~SpawnPlan() {
        posix_spawn_file_actions_destroy(&files);
        posix_spawnattr_destroy(&attributes);
    }

    posix_spawn_file_actions_t files{};
    posix_spawnattr_t attributes{};
};

}  // namespace

VideoPipe::VideoPipe(std::string file, double pictures_per_second)
    : file_(std::move(file)), rate_(pictures_per_second) {}

VideoPipe::~VideoPipe() { end(); }

void VideoPipe::start(uint32_t width, uint32_t height) {
    width_ = width;
    height_ = height;
    // An ffmpeg that ends early shall not end us.
    std::signal(SIGPIPE, SIG_IGN);
    std::array<int, 2> ends{-1, -1};
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
        throw OperatorError(fmt::format("Cannot make a pipe to ffmpeg: {}. Record to a folder instead.",
                                        std::generic_category().message(errno)));
    std::vector<std::string> words = command_of(file_, rate_, width, height);
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_t process = -1;
    int failure = 0;
    {
        const SpawnPlan plan(ends[0]);
        failure = posix_spawnp(&process, "ffmpeg", &plan.files, &plan.attributes, arguments.data(), environ);
    }
    close(ends[0]);
    if (failure != 0) {
        close(ends[1]);
        throw OperatorError(
            failure == ENOENT
                ? fmt::format(
                      "--record {}: videos are made by ffmpeg, which is not installed here (Debian: apt "
                      "install ffmpeg). Or name a folder, which gets the pictures as PNG files.",
                      file_)
                : fmt::format("--record {}: ffmpeg cannot be started: {}. Record to a folder instead.", file_,
                              std::generic_category().message(failure)));
    }
    input_ = ends[1];
    process_ = process;
}

void VideoPipe::add(const Picture& picture, uint64_t times) {
    if (process_ < 0) start(picture.width, picture.height);
    if (picture.width != width_ || picture.height != height_)
        throw OperatorError(fmt::format(
            "{}: a video keeps its size of {} x {}, and the picture has become {} x {}. Record to "
            "a folder to change sizes.",
            file_, width_, height_, picture.width, picture.height));
    for (; times > 0; --times) write_bytes(picture.rgb);
}

void VideoPipe::write_bytes(const std::vector<uint8_t>& bytes) {
    const uint8_t* at = bytes.data();
    size_t left = bytes.size();
    while (left > 0) {
        const ssize_t written = write(input_, at, left);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) {
            const int status = end();
            throw OperatorError(fmt::format(
                "{}: ffmpeg has ended early (status {}); above it says why. Is the disk full, or the "
                "format one that this ffmpeg lacks? A folder takes the pictures as PNG files.",
                file_, status));
        }
        at += written;
        left -= static_cast<size_t>(written);
    }
}

int VideoPipe::end() {
    if (input_ >= 0) close(std::exchange(input_, -1));
    if (process_ < 0) return 0;
    int status = 0;
    const pid_t process = std::exchange(process_, -1);
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void VideoPipe::finish() {
    if (const int status = end(); status != 0)
        throw OperatorError(fmt::format(
            "{}: ffmpeg could not finish the video (status {}); above it says why. Is the disk full?", file_,
            status));
}

}  // namespace trochoid
