#pragma once
#include <algorithm>
#include <cstdint>

namespace trochoid {

/// The io thread's time that one session may take for its results: a fiftieth on the average, two seconds' worth at once. What costs more
/// is computed aside, where nobody waits for it. Times are monotonic, microseconds.
class SessionShare {
public:
    static constexpr int64_t one_in = 50;
    static constexpr int64_t full_us = 2'000'000 / one_in;

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

}  // namespace trochoid
