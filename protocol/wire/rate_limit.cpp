#include "protocol/wire/rate_limit.hpp"

#include <algorithm>

#include "protocol/units/assert.hpp"

namespace trochoid {

RateLimit::RateLimit(uint32_t per_second, uint32_t burst)
    : per_second_(per_second), full_(uint64_t{burst} * one), level_(full_) {
    TROCHOID_ASSERT(per_second > 0 && burst > 0, "{} per second, burst {}", per_second, burst);
}

bool RateLimit::take(int64_t now_us) {
    if (!started_) {
        started_ = true;
        last_us_ = now_us;
    }
    if (now_us > last_us_) {
        const auto elapsed = static_cast<uint64_t>(now_us) - static_cast<uint64_t>(last_us_);
        const uint64_t missing = full_ - level_;
        // Compared by division, so that a long pause cannot overflow.
        level_ = elapsed > missing / per_second_ ? full_ : level_ + elapsed * per_second_;
        last_us_ = now_us;
    }
    if (level_ < one) return false;
    level_ -= one;
    return true;
}

}  // namespace trochoid
