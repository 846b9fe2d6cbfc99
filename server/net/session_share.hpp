#pragma once
#include <algorithm>
#include <cstdint>

namespace trochoid {

/// The io thread's time that results may take: one part in `one_in` on the average, `most_at_once_us` at once. What costs more is computed aside,
/// where nobody waits for it. Times are monotonic, microseconds.
template <int64_t one_in, int64_t most_at_once_us>
class IoShare {
public:
    static constexpr int64_t full_us = most_at_once_us;

    bool left(int64_t now_us) {
        const int64_t gained_us = std::max<int64_t>(now_us - counted_us_, 0) / one_in;
        left_us_ = std::min(full_us, left_us_ + gained_us);
        counted_us_ += gained_us * one_in;
        return left_us_ > 0;
    }
    /// May go below nothing: what a result costs is known afterwards.
    void spend(int64_t us) { left_us_ -= us; }

private:
    int64_t left_us_ = full_us;
    int64_t counted_us_ = 0;
};

/// What one session may take: two seconds' worth at once.
using SessionShare = IoShare<50, 40'000>;
/// What all sessions together may take; half the thread stays for everything else.
using ServerShare = IoShare<2, 200'000>;

}  // namespace trochoid
