#pragma once
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <ctime>
#include <functional>
#include <vector>

namespace trochoid::bench {

/// Which time counts: that of the calling thread's own instructions (one core: what else runs on the machine does not
/// count), or what a clock on the wall shows (several threads).
enum class Clock { thread, wall };

inline double now(Clock clock) {
    if (clock == Clock::wall)
        return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Seconds that one call takes.
template <class Work>
double seconds(Work&& work, Clock clock = Clock::wall) {
    const double start = now(clock);
    work();
    return now(clock) - start;
}

inline double median(std::vector<double> values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Keeps the compiler from dropping what a result depends on.
template <class T>
void keep(const T& value) {
    asm volatile("" : : "r"(&value) : "memory");
}

/// Times of several contenders, round by round: a disturbance hits them alike, and ratios are taken within a round.
class Interleaved {
public:
    /// Each contender is called until it has taken about `least_seconds` per round, after one warming call.
    Interleaved(const std::vector<std::function<void()>>& contenders, int rounds, double least_seconds,
                Clock clock = Clock::thread) {
        std::vector<int> repeats;
        for (const auto& work : contenders) {
            work();
            const double once = std::max(seconds(work, clock), 1e-8);
            repeats.push_back(std::max(1, static_cast<int>(least_seconds / once)));
        }
        times_.resize(contenders.size());
        for (int round = 0; round < rounds; ++round)
            for (size_t i = 0; i < contenders.size(); ++i) {
                const double taken = seconds(
                    [&] {
                        for (int repeat = 0; repeat < repeats[i]; ++repeat) contenders[i]();
                    },
                    clock);
                times_[i].push_back(taken / repeats[i]);
            }
    }
    /// Median seconds of a call.
    double time(size_t contender) const { return median(times_[contender]); }
    /// Median over the rounds of time(a) / time(b).
    double ratio(size_t a, size_t b) const {
        std::vector<double> ratios;
        for (size_t i = 0; i < times_[a].size(); ++i) ratios.push_back(times_[a][i] / times_[b][i]);
        return median(ratios);
    }

private:
    std::vector<std::vector<double>> times_;
};

}  // namespace trochoid::bench
