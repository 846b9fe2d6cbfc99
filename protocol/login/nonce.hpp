#pragma once
#include <array>
#include <compare>
#include <cstdint>

namespace trochoid {

/// The wall clock, for how long tokens and tickets are good: seconds since 1970-01-01 00:00 UTC without leap seconds.
struct UnixSeconds {
    uint64_t value = 0;
    auto operator<=>(const UnixSeconds&) const = default;
};

/// Beyond it (the year 36,812) no time is taken, so that sums of a few never overflow.
inline constexpr uint64_t latest_unix_second = uint64_t{1} << 40;

/// 16 bytes that come once.
using Nonce = std::array<uint8_t, 16>;

/// From the operating system's random numbers.
Nonce random_nonce();

}  // namespace trochoid
