#pragma once
#include <cstdint>

namespace trochoid {

/// Which viewers need a token. Directors and admins always do.
enum class ViewerTokens : uint8_t {
    off_loopback,  ///< all but those on this machine
    always,
    never,
};

}  // namespace trochoid
