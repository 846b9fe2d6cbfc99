#pragma once
#include <chrono>
#include <functional>
#include <memory>

namespace trochoid {

/// The thread on which everything with a socket happens: sessions, listeners, timers, and the world's owner in app. Only
/// `post` may be called from another thread; `assert_here` guards the crossings.
class IoLoop {
public:
    IoLoop();
    IoLoop(const IoLoop&) = delete;
    IoLoop& operator=(const IoLoop&) = delete;
    ~IoLoop();

    /// Runs on the calling thread until `stop`.
    void run();
    /// Ends `run` after the handler in progress; from the loop's thread.
    void stop();
    /// Runs a task on the loop's thread, soon; from any thread, also before `run`.
    void post(std::function<void()> task);
    /// Asserts that the caller is on the loop's thread (or that no thread runs it).
    void assert_here() const;
    /// Calls back on the loop at the first SIGINT or SIGTERM; a second one ends the process at once.
    void on_terminate(std::function<void(int signal)> handler);
    /// Calls back on the loop at every SIGHUP, which ends the process where nobody asks for it.
    void on_hangup(std::function<void()> handler);

    struct Impl;
    Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

/// One pending call on the loop at a time. Destruction and `stop` forget it.
class LoopTimer {
public:
    explicit LoopTimer(IoLoop& loop);
    LoopTimer(const LoopTimer&) = delete;
    LoopTimer& operator=(const LoopTimer&) = delete;
    ~LoopTimer();

    /// Replaces what was pending.
    void start(std::chrono::milliseconds delay, std::function<void()> task);
    void stop();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid
