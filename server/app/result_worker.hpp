#pragma once
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

#include "server/net/io_loop.hpp"

namespace trochoid {

/// Computes results aside, in order of asking, on a thread that gives way to every other: whoever asks for much waits for it and holds up
/// nobody who asks for little. Destruction waits for the job in progress and drops the others.
class ResultWorker {
public:
    /// Runs on the worker's thread; what it returns runs on the io thread.
    using Job = std::function<std::function<void()>()>;

    explicit ResultWorker(IoLoop& loop);
    ResultWorker(const ResultWorker&) = delete;
    ResultWorker& operator=(const ResultWorker&) = delete;
    ~ResultWorker();

    void ask(Job job);

private:
    void work();

    IoLoop& loop_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<Job> jobs_;
    bool stopping_ = false;
    std::thread thread_;
};

}  // namespace trochoid
