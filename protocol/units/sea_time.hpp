#pragma once
#include <compare>
#include <cstdint>

namespace trochoid {

/// The server's simulation clock: int64 microseconds since the world's beginning. Never a float, never a wall clock.
struct SeaTime {
    int64_t us = 0;
    auto operator<=>(const SeaTime&) const = default;
};

/// Latest and earliest sea time that may be asked for: ±2^61 us (73,000 years), so differences never overflow.
inline constexpr int64_t sea_time_bound = int64_t{1} << 61;

/// "Never ends" in validity spans.
inline constexpr SeaTime end_of_time{sea_time_bound};

inline constexpr int64_t microseconds_per_second = 1'000'000;

constexpr SeaTime operator+(SeaTime t, int64_t us) { return {t.us + us}; }
constexpr SeaTime operator-(SeaTime t, int64_t us) { return {t.us - us}; }
constexpr int64_t operator-(SeaTime a, SeaTime b) { return a.us - b.us; }

/// Seconds to microseconds, rounded half away from zero.
constexpr int64_t seconds_to_us(double seconds) {
    const double us = seconds * 1e6;
    return static_cast<int64_t>(us < 0.0 ? us - 0.5 : us + 0.5);
}

}  // namespace trochoid
