#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

namespace trochoid {

/// This machine's monotonic clock, microseconds since an arbitrary moment: the client's side of every clock exchange.
int64_t client_monotonic_us();

/// One thread on which everything with a socket happens. Tasks run there in the order in which they were posted. Outlives
/// every connection on it; ends (and joins) with its owner at the latest.
class NetLoop {
public:
    NetLoop();
    NetLoop(const NetLoop&) = delete;
    NetLoop& operator=(const NetLoop&) = delete;
    ~NetLoop();

    /// Ends the thread after the task in progress; what was still pending never runs. For owners whose sockets have to go
    /// before the loop does. Not from the loop's own thread.
    void stop();
    /// Runs the task on the loop's thread, soon. From any thread.
    void post(std::function<void()> task);
    /// Runs the task on the loop's thread after the delay. From any thread; cannot be taken back, so tasks hold weak
    /// pointers to what may be gone by then.
    void after(std::chrono::milliseconds delay, std::function<void()> task);
    /// Asserts that the caller is on the loop's thread.
    void assert_here() const;

    struct Impl;
    Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid
