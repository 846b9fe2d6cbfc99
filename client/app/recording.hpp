#pragma once
#include <cstdint>
#include <ctime>
#include <memory>
#include <string>

#include "client/gpu/render_target.hpp"

namespace trochoid {

/// Where the pictures of a recording go, one after the other. An end without finish() leaves what there is.
class PictureSink {
public:
    PictureSink() = default;
    PictureSink(const PictureSink&) = delete;
    PictureSink& operator=(const PictureSink&) = delete;
    virtual ~PictureSink() = default;
    /// Adds a picture so many times. Throws OperatorError where it cannot be kept (the disk is full, ffmpeg has ended).
    virtual void add(const Picture& picture, uint64_t times) = 0;
    /// Waits until all is on the disk. Throws as add().
    virtual void finish() = 0;
};

/// Whether a name is a video's (.mp4, .mkv, .webm), else it is a folder's.
bool is_video(const std::string& where);

/// A folder gets frame_000000.png, frame_000001.png and so on; it is made, or has to be empty. A video goes through ffmpeg
/// and must not exist. Throws OperatorError with advice.
std::unique_ptr<PictureSink> open_recording(const std::string& where, double pictures_per_second);

/// A recording in progress: a constant number of pictures a second.
class Recording {
public:
    static constexpr double usual_rate = 30.0;

    /// `every_frame`: each frame is a picture (fixed step). Else as many pictures as `rate` wants: where drawing is slower they are repeated,
    /// where it is faster some frames are left out.
    Recording(std::string where, double rate, bool every_frame);

    /// `seconds` since the recording's first frame, real time.
    void add(const Picture& picture, double seconds);
    /// How many pictures a frame at this moment is worth: 0 need not be read from the GPU at all.
    uint64_t wanted_at(double seconds) const;
    void finish();

    uint64_t pictures() const { return pictures_; }
    const std::string& where() const { return where_; }

private:
    std::string where_;
    double rate_;
    bool every_frame_;
    std::unique_ptr<PictureSink> sink_;
    uint64_t pictures_ = 0;
};

/// "trochoid-20261122-141500.png" for a local time, in the folder at hand; with -2, -3 … before the ending where that exists.
std::string stamped_name(std::time_t now, const std::string& ending);

}  // namespace trochoid
