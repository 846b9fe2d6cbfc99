#include "server/app/result_worker.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <utility>

namespace trochoid {

namespace {

// A tenth of a core at least where others want all of it.
constexpr int niceness = 10;

}  // namespace

ResultWorker::ResultWorker(IoLoop& loop) : loop_(loop) {
    thread_ = std::thread([this] { work(); });
}

ResultWorker::~ResultWorker() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
        jobs_.clear();
    }
    wake_.notify_one();
    thread_.join();
}

void ResultWorker::ask(Job job) {
    {
        const std::lock_guard lock(mutex_);
        jobs_.push_back(std::move(job));
    }
    wake_.notify_one();
}

void ResultWorker::work() {
    // On Linux of this thread alone; where it is refused, results aside only compete.
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), niceness);
    while (true) {
        Job job;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
            if (stopping_) return;
            job = std::move(jobs_.front());
            jobs_.pop_front();
        }
        loop_.post(job());
    }
}

}  // namespace trochoid
