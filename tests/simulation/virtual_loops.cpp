// The loops and clocks of server/net and client/net under virtual time, and chance: linked in their place.
#include <random>

#include "client/net/net_loop.hpp"
#include "server/net/io_loop.hpp"
#include "server/net/monotonic.hpp"
#include "tests/simulation/virtual_time.hpp"

namespace trochoid {

namespace {

/// Tasks that are dropped once their loop is gone.
struct Tasks {
    std::shared_ptr<int> alive = std::make_shared<int>();
    void at(int64_t us, std::function<void()> task) const {
        VirtualTime::current().at(us, guarded(std::move(task)));
    }
    std::function<void()> guarded(std::function<void()> task) const {
        return [still = std::weak_ptr<int>(alive), task = std::move(task)] {
            if (!still.expired()) task();
        };
    }
};

}  // namespace

int64_t monotonic_us() { return VirtualTime::current().now_us(); }
// Another machine's clock: its zero lies elsewhere.
int64_t client_monotonic_us() { return VirtualTime::current().now_us() + 77'000'000'000; }

}  // namespace trochoid

// Numbers of sessions, challenges and seeds of winds: else a life would not follow from its seed.
std::random_device::result_type std::random_device::_M_getval() {
    return trochoid::VirtualTime::current().random();
}

namespace trochoid {

struct IoLoop::Impl : Tasks {};
IoLoop::IoLoop() : impl_(std::make_unique<Impl>()) {}
IoLoop::~IoLoop() = default;
void IoLoop::run() {}
void IoLoop::stop() {}
void IoLoop::post(std::function<void()> task) {
    VirtualTime& time = VirtualTime::current();
    if (time.on_another_thread()) return time.hand_in(impl_->guarded(std::move(task)));
    impl_->at(time.now_us(), std::move(task));
}
void IoLoop::assert_here() const {}
// NOLINTNEXTLINE(performance-unnecessary-value-param): the real loop keeps it
void IoLoop::on_terminate(std::function<void(int)>) {}

struct LoopTimer::Impl : Tasks {
    uint64_t row = 0;
};
LoopTimer::LoopTimer(IoLoop&) : impl_(std::make_unique<Impl>()) {}
LoopTimer::~LoopTimer() = default;
void LoopTimer::start(std::chrono::milliseconds delay, std::function<void()> task) {
    impl_->at(VirtualTime::current().now_us() + delay.count() * 1000,
              [impl = impl_.get(), row = ++impl_->row, task = std::move(task)] {
                  if (row == impl->row) task();
              });
}
void LoopTimer::stop() { ++impl_->row; }

struct NetLoop::Impl : Tasks {};
NetLoop::NetLoop() : impl_(std::make_unique<Impl>()) {}
NetLoop::~NetLoop() = default;
void NetLoop::stop() { impl_->alive.reset(); }
void NetLoop::post(std::function<void()> task) {
    impl_->at(VirtualTime::current().now_us(), std::move(task));
}
void NetLoop::after(std::chrono::milliseconds delay, std::function<void()> task) {
    impl_->at(VirtualTime::current().now_us() + delay.count() * 1000, std::move(task));
}
void NetLoop::assert_here() const {}

}  // namespace trochoid
