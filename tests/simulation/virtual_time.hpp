#pragma once
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace trochoid {

/// The clock and the one thread of a simulated world: tasks by time, then in the order in which they were given. The last one made
/// is what the loops, the monotonic clocks and the random numbers of a simulation go by.
class VirtualTime {
public:
    explicit VirtualTime(uint64_t seed = 1);
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
    /// What the programs take for chance.
    uint32_t random();

    /// From another thread (a land worker): one task at a time, for who waits for it.
    bool on_another_thread() const { return std::this_thread::get_id() != home_; }
    void hand_in(std::function<void()> task);
    /// Waits, in real time, for what a worker that has been asked hands in.
    std::function<void()> handed_in();

private:
    int64_t now_us_ = 1'000'000'000;
    uint64_t given_ = 0;
    uint64_t run_ = 0;
    uint64_t dice_;
    std::map<std::pair<int64_t, uint64_t>, std::function<void()>> tasks_;
    std::thread::id home_ = std::this_thread::get_id();
    std::mutex mutex_;
    std::condition_variable news_;
    std::optional<std::function<void()>> handed_in_;
};

}  // namespace trochoid
