#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "client/app/recording.hpp"

namespace trochoid {

/// A video file that ffmpeg makes from pictures on its standard input: H.264 in .mp4 and .mkv, VP9 in .webm. ffmpeg starts with
/// the first picture, whose size is that of all.
class VideoPipe : public PictureSink {
public:
    VideoPipe(std::string file, double pictures_per_second);
    ~VideoPipe() override;

    /// Throws OperatorError where ffmpeg is not there or has ended, or the picture has another size than the first.
    void add(const Picture& picture, uint64_t times) override;
    void finish() override;

private:
    void start(uint32_t width, uint32_t height);
    void write_bytes(const std::vector<uint8_t>& bytes);
    /// Closes ffmpeg's input and waits for its end; its exit status, -1 where it did not exit.
    int end();

    std::string file_;
    double rate_;
    uint32_t width_ = 0;
    uint32_t height_ = 0;
    int input_ = -1;    // ffmpeg's standard input
    int process_ = -1;  // its id
};

}  // namespace trochoid
