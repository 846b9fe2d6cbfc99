#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trochoid {

/// RFC 4648, chapter 5, without padding.
std::string base64url(std::span<const uint8_t> bytes);

/// The bytes of a text of at most 4096 characters. Nothing for any other text than `base64url` writes: no padding, no
/// blanks, no bits left over.
std::optional<std::vector<uint8_t>> from_base64url(std::string_view text);

}  // namespace trochoid
