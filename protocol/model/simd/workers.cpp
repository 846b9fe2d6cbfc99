#include "protocol/model/simd/workers.hpp"

#include <algorithm>
#include <exception>

namespace trochoid {

Workers::Workers(unsigned threads) {
    const unsigned wanted = threads != 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
    pool_.reserve(wanted - 1);
    for (unsigned thread = 1; thread < wanted; ++thread)
        pool_.emplace_back([this, thread](const std::stop_token& stop) { serve(stop, thread); });
}

Workers::~Workers() {
    for (std::jthread& thread : pool_) thread.request_stop();
}

void Workers::run(size_t parts, const std::function<void(size_t, unsigned)>& work) {
    if (pool_.empty() || parts <= 1) {
        for (size_t part = 0; part < parts; ++part) work(part, 0);
        return;
    }
    {
        const std::lock_guard lock(mutex_);
        work_ = &work;
        parts_ = parts;
        next_ = 0;
        failure_ = nullptr;
        ++round_;
        busy_ = threads();
    }
    changed_.notify_all();
    take_parts(0);
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return busy_ == 0; });
    work_ = nullptr;
    if (failure_) std::rethrow_exception(failure_);
}

void Workers::serve(const std::stop_token& stop, unsigned thread) {
    uint64_t served = 0;
    while (true) {
        {
            std::unique_lock lock(mutex_);
            if (!changed_.wait(lock, stop, [&] { return round_ != served && work_ != nullptr; })) return;
            served = round_;
        }
        take_parts(thread);
    }
}

void Workers::take_parts(unsigned thread) {
    std::unique_lock lock(mutex_);
    while (next_ < parts_) {
        const size_t part = next_++;
        const auto* work = work_;
        lock.unlock();
        std::exception_ptr failure;
        try {
            (*work)(part, thread);
        } catch (...) {
            failure = std::current_exception();
        }
        lock.lock();
        if (failure) {
            failure_ = failure;
            next_ = parts_;
        }
    }
    if (--busy_ == 0) changed_.notify_all();
}

}  // namespace trochoid
