#pragma once
#include <cstdint>

namespace trochoid {

/// The server's monotonic clock, microseconds since an arbitrary moment: the m of SeaClock, of clock replies and of every
/// deadline here.
int64_t monotonic_us();

}  // namespace trochoid
