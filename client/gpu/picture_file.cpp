#include "client/gpu/picture_file.hpp"

#include <fmt/format.h>
#include <png.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

struct FileCloser {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

[[noreturn]] void refuse(const std::string& path, int why) {
    throw OperatorError(fmt::format(
        "Cannot write the picture {}: {}. Name a file in a folder that you may write to and that has room.",
        path, std::generic_category().message(why)));
}

}  // namespace

std::vector<uint8_t> encode_png(const Picture& picture) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = picture.width;
    image.height = picture.height;
    image.format = PNG_FORMAT_RGB;
    std::vector<uint8_t> bytes(PNG_IMAGE_PNG_SIZE_MAX(image));
    png_alloc_size_t size = bytes.size();
    if (png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr) == 0)
        throw OperatorError(fmt::format("Cannot encode a picture of {} x {}: {}.", picture.width,
                                        picture.height, image.message));
    bytes.resize(size);
    return bytes;
}

void write_png(const std::string& path, const Picture& picture) {
    write_picture_file(path, encode_png(picture));
}

void write_picture_file(const std::string& path, const std::vector<uint8_t>& bytes) {
    std::unique_ptr<std::FILE, FileCloser> file(std::fopen(path.c_str(), "wb"));
    if (!file) refuse(path, errno);
    // A full disk shows when the bytes are written, or only when the file is closed.
    const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
    const int why = errno;
    const bool closed = std::fclose(file.release()) == 0;
    if (!written) refuse(path, why);
    if (!closed) refuse(path, errno);
}

}  // namespace trochoid
