#pragma once
#include <cstdint>

#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// How sea time follows the server's monotonic clock within one time epoch: T = start + rate * (m - monotonic_start).
/// Rates and jumps are events that open a new epoch; within one nothing steps back.
struct SeaClock {
    uint32_t epoch = 1;
    SeaTime start;                   ///< sea time at monotonic_start_us
    int64_t monotonic_start_us = 0;  ///< server's monotonic clock
    uint32_t rate_q16 = 1U << 16;    ///< Q16.16, 0 (paused) to 16
    bool operator==(const SeaClock&) const = default;
};

inline constexpr uint32_t largest_rate_q16 = 16U << 16;

/// Sea time at a monotonic moment. The product is split so that a thousand years fit.
constexpr SeaTime sea_time_at(const SeaClock& clock, int64_t monotonic_us) {
    const int64_t elapsed = monotonic_us - clock.monotonic_start_us;
    const int64_t whole = elapsed >> 16;
    const int64_t part = elapsed & 0xffff;
    return {clock.start.us + whole * int64_t{clock.rate_q16} + ((part * int64_t{clock.rate_q16}) >> 16)};
}

}  // namespace trochoid
