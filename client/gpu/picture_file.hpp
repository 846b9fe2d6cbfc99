#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "client/gpu/render_target.hpp"

namespace trochoid {

/// The same picture gives the same bytes.
std::vector<uint8_t> encode_png(const Picture& picture);

/// Writes the bytes of a picture to a file, in place of an older one. Throws OperatorError where the file cannot be written whole.
void write_picture_file(const std::string& path, const std::vector<uint8_t>& bytes);
/// Writes a PNG file, in place of an older one. Throws OperatorError where the file cannot be written whole.
void write_png(const std::string& path, const Picture& picture);

}  // namespace trochoid
