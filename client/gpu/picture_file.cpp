#include "client/gpu/picture_file.hpp"

#include <fmt/format.h>
#include <png.h>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

void write_png(const std::string& path, const Picture& picture) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = picture.width;
    image.height = picture.height;
    image.format = PNG_FORMAT_RGB;
    if (png_image_write_to_file(&image, path.c_str(), 0, picture.rgb.data(), 0, nullptr) == 0)
        throw OperatorError(
            fmt::format("Cannot write the picture {}: {}. Name a file in a folder that you may write to.",
                        path, image.message));
}

}  // namespace trochoid
