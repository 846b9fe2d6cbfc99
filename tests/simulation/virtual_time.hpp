#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <utility>

namespace trochoid {

/// The clock and the one thread of a simulated world: tasks by time, then in the order in which they were given. The last one made
/// is what the loops and the monotonic clocks of a simulation go by.
class VirtualTime {
public:
    VirtualTime();
    VirtualTime(const VirtualTime&) = delete;
    VirtualTime& operator=(const VirtualTime&) = delete;
    ~VirtualTime();
    static VirtualTime& current();

    int64_t now_us() const { return now_us_; }
    /// Not before now.
    void at(int64_t us, std::function<void()> task);
    void soon(std::function<void()> task) { at(now_us_, std::move(task)); }
    /// Runs all tasks up to this time, and those that they add.
    void run_until(int64_t us);
    uint64_t tasks_run() const { return run_; }

private:
    int64_t now_us_ = 1'000'000'000;
    uint64_t given_ = 0;
    uint64_t run_ = 0;
    std::map<std::pair<int64_t, uint64_t>, std::function<void()>> tasks_;
};

}  // namespace trochoid
