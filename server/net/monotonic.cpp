#include "server/net/monotonic.hpp"

#include <chrono>

namespace trochoid {

int64_t monotonic_us() {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace trochoid
