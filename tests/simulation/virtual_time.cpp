#include "tests/simulation/virtual_time.hpp"

#include <algorithm>

#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {

namespace {

VirtualTime* the_current = nullptr;
// A run that does more goes round in circles.
constexpr uint64_t most_tasks = 5'000'000;

}  // namespace

VirtualTime::VirtualTime(uint64_t seed) : dice_(splitmix64(seed ^ 0x7a5e)) { the_current = this; }

VirtualTime::~VirtualTime() {
    // Tasks may own what gives further ones when it goes.
    while (!tasks_.empty()) tasks_.erase(tasks_.begin());
    the_current = nullptr;
}

VirtualTime& VirtualTime::current() {
    TROCHOID_ASSERT(the_current != nullptr, "outside of a simulation's time");
    return *the_current;
}

void VirtualTime::at(int64_t us, std::function<void()> task) {
    tasks_.emplace(std::pair(std::max(us, now_us_), given_++), std::move(task));
}

void VirtualTime::run_until(int64_t us) {
    while (!tasks_.empty() && tasks_.begin()->first.first <= us) {
        auto next = tasks_.extract(tasks_.begin());
        now_us_ = next.key().first;
        ++run_;
        TROCHOID_ASSERT(run_ < most_tasks, "{} tasks and no end, at {} us", run_, now_us_);
        next.mapped()();
    }
    now_us_ = std::max(now_us_, us);
}

uint32_t VirtualTime::random() { return static_cast<uint32_t>((dice_ = splitmix64(dice_)) >> 32); }

void VirtualTime::hand_in(std::function<void()> task) {
    {
        const std::lock_guard lock(mutex_);
        TROCHOID_ASSERT(!handed_in_, "two tasks are handed in at once");
        handed_in_ = std::move(task);
    }
    news_.notify_one();
}

std::function<void()> VirtualTime::handed_in() {
    std::unique_lock lock(mutex_);
    news_.wait(lock, [this] { return handed_in_.has_value(); });
    auto task = std::move(*handed_in_);
    handed_in_.reset();
    return task;
}

}  // namespace trochoid
