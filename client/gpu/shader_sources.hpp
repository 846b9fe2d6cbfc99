#pragma once
#include <map>
#include <string_view>

namespace trochoid {

/// Every shader of shaders/ by file name, includes joined, without the #version line.
const std::map<std::string_view, std::string_view>& shader_sources();

}  // namespace trochoid
