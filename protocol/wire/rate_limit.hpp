#pragma once
#include <cstdint>

namespace trochoid {

/// Token bucket on a monotonic time that the caller passes in: `per_second` on the average, `burst` at once.
class RateLimit {
public:
    /// Starts full. Both at least 1; without `burst` a second's worth.
    RateLimit(uint32_t per_second, uint32_t burst);
    explicit RateLimit(uint32_t per_second) : RateLimit(per_second, per_second) {}

    /// Takes one token at monotonic time now_us; false where there is none. Time that steps back counts as standing still.
    bool take(int64_t now_us);

private:
    static constexpr uint64_t one =
        1'000'000;  // tokens are kept in millionths: a microsecond brings per_second of them

    uint64_t per_second_;
    uint64_t full_;
    uint64_t level_;
    int64_t last_us_ = 0;
    bool started_ = false;
};

}  // namespace trochoid
