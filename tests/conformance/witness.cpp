#include "tests/conformance/witness.hpp"

#include <algorithm>

#include "tests/conformance/server_trial.hpp"

namespace trochoid::conformance {

namespace {

// Without anybody waiting, to keep its session alive.
constexpr Milliseconds pause{200};
// Between exchanges that somebody waits for: 200 a second, well within any rate.
constexpr Milliseconds breath{5};

}  // namespace

Witness::Witness(const Target& target) : target_(target), thread_([this] { stand(); }) {}

Witness::~Witness() {
    {
        const std::lock_guard lock(mutex_);
        over_ = true;
        news_.notify_all();
    }
    thread_.join();
}

void Witness::stand() {
    std::unique_lock lock(mutex_);
    while (!over_) {
        lock.unlock();
        ServerTrial trial(target_);
        try {
            ServerPeer& peer = trial.log_in();
            lock.lock();
            while (!over_) {
                wanted_ = false;
                const uint64_t number = ++begun_;
                lock.unlock();
                const int64_t begin_us = monotonic_us();
                peer.ask_clock();
                const int64_t took_us = monotonic_us() - begin_us;
                lock.lock();
                answered_ = number;
                ++exchanges_;
                slowest_us_ = std::max(slowest_us_, took_us);
                trouble_.clear();
                news_.notify_all();
                news_.wait_for(lock, breath, [this] { return over_; });
                news_.wait_for(lock, pause, [this] { return over_ || wanted_; });
            }
        } catch (const Failed& failed) {
            if (!lock.owns_lock()) lock.lock();
            trouble_ = failed.reason;
            news_.notify_all();
            news_.wait_for(lock, pause, [this] { return over_; });
        }
    }
}

void Witness::confirm() {
    std::unique_lock lock(mutex_);
    wanted_ = true;
    const uint64_t wanted = begun_ + 1;
    news_.notify_all();
    if (!news_.wait_for(lock, 2 * target_.patience, [&] { return answered_ >= wanted; }))
        throw Failed{"the server no longer serves another session" +
                     (trouble_.empty() ? std::string() : " (" + trouble_ + ")")};
}

uint64_t Witness::exchanges() const {
    const std::lock_guard lock(mutex_);
    return exchanges_;
}

int64_t Witness::slowest_us() const {
    const std::lock_guard lock(mutex_);
    return slowest_us_;
}

}  // namespace trochoid::conformance
