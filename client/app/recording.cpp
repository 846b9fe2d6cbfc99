#include "client/app/recording.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include "client/app/video_pipe.hpp"
#include "client/gpu/picture_file.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

namespace fs = std::filesystem;

/// frame_000000.png and so on in a folder of their own.
class PictureFolder : public PictureSink {
public:
    explicit PictureFolder(const std::string& folder) : folder_(folder) {
        std::error_code failure;
        if (fs::exists(folder_, failure) && !fs::is_directory(folder_, failure))
            throw OperatorError(fmt::format(
                "--record {}: that is a file. Name a folder, or a video ending in .mp4, .mkv or .webm.",
                folder));
        fs::create_directories(folder_, failure);
        if (failure)
            throw OperatorError(
                fmt::format("--record {}: the folder cannot be made ({}). Name one that you may write to.",
                            folder, failure.message()));
        if (!fs::is_empty(folder_, failure))
            throw OperatorError(fmt::format(
                "--record {}: the folder is not empty, and a recording never writes over files. Name a new "
                "folder, or empty this one.",
                folder));
    }
    void add(const Picture& picture, uint64_t times) override {
        const std::vector<uint8_t> png = encode_png(picture);
        for (; times > 0; --times) {
            write_picture_file((folder_ / fmt::format("frame_{:06}.png", number_)).string(), png);
            ++number_;
        }
    }
    void finish() override {}

private:
    fs::path folder_;
    uint64_t number_ = 0;
};

}  // namespace

bool is_video(const std::string& where) {
    const std::string ending = fs::path(where).extension().string();
    return ending == ".mp4" || ending == ".mkv" || ending == ".webm";
}

std::unique_ptr<PictureSink> open_recording(const std::string& where, double pictures_per_second) {
    if (!is_video(where)) return std::make_unique<PictureFolder>(where);
    std::error_code failure;
    if (fs::exists(where, failure))
        throw OperatorError(fmt::format(
            "--record {}: the file exists, and a recording never writes over files. Name another, or remove it.",
            where));
    return std::make_unique<VideoPipe>(where, pictures_per_second);
}

Recording::Recording(std::string where, double rate, bool every_frame)
    : where_(std::move(where)), rate_(rate), every_frame_(every_frame), sink_(open_recording(where_, rate)) {}

uint64_t Recording::wanted_at(double seconds) const {
    if (every_frame_) return 1;
    const auto due = static_cast<uint64_t>(std::max(std::floor(seconds * rate_), 0.0)) + 1;
    return due > pictures_ ? due - pictures_ : 0;
}

void Recording::add(const Picture& picture, double seconds) {
    const uint64_t wanted = wanted_at(seconds);
    if (wanted == 0) return;
    sink_->add(picture, wanted);
    pictures_ += wanted;
}

void Recording::finish() { sink_->finish(); }

std::string stamped_name(std::time_t now, const std::string& ending) {
    const std::string stem = fmt::format("trochoid-{:%Y%m%d-%H%M%S}", fmt::localtime(now));
    std::error_code none;
    for (int number = 1;; ++number) {
        std::string name = number == 1 ? stem + ending : fmt::format("{}-{}{}", stem, number, ending);
        if (!fs::exists(name, none)) return name;
    }
}

}  // namespace trochoid
