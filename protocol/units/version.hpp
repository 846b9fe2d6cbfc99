#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace trochoid {

/// Version of this software, for logs and the hello; never a reason to refuse.
std::string_view software_version();

/// Range of wire protocol versions that this build speaks.
inline constexpr uint16_t protocol_version_min = 2;
inline constexpr uint16_t protocol_version_max = 3;

/// Version of the deterministic sea (protocol/README.md, "The sea"). A different one computes another sea.
inline constexpr uint16_t model_version = 2;

/// The text that `--version` prints: program, software, protocol and model versions.
std::string version_text(std::string_view program);

}  // namespace trochoid
