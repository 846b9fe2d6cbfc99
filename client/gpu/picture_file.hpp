#pragma once
#include <string>

#include "client/gpu/render_target.hpp"

namespace trochoid {

/// Writes a PNG file. Throws OperatorError where the file cannot be written.
void write_png(const std::string& path, const Picture& picture);

}  // namespace trochoid
