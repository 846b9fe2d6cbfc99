#pragma once
#include <chrono>
#include <cstdint>

namespace trochoid {

/// The server's monotonic clock, microseconds since an arbitrary moment: the m of SeaClock, of clock replies and of every
/// deadline here.
inline int64_t monotonic_us() {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace trochoid
