#include "server/net/io_loop.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <csignal>
#include <utility>

#include "protocol/units/assert.hpp"
#include "server/net/io_loop_asio.hpp"

namespace trochoid {

namespace asio = boost::asio;

IoLoop::IoLoop() : impl_(std::make_unique<Impl>()) {}
IoLoop::~IoLoop() = default;

void IoLoop::run() {
    const auto work = asio::make_work_guard(impl_->context);
    impl_->owner = std::this_thread::get_id();
    impl_->context.run();
    impl_->owner = std::thread::id{};
}

void IoLoop::stop() {
    assert_here();
    impl_->context.stop();
}

void IoLoop::post(std::function<void()> task) { asio::post(impl_->context, std::move(task)); }

void IoLoop::assert_here() const {
    const std::thread::id owner = impl_->owner;
    TROCHOID_ASSERT(owner == std::thread::id{} || owner == std::this_thread::get_id(),
                    "called off the io thread");
}

void IoLoop::on_terminate(std::function<void(int)> handler) {
    impl_->signals.add(SIGINT);
    impl_->signals.add(SIGTERM);
    impl_->signals.async_wait(
        [this, handler = std::move(handler)](const boost::system::error_code& failed, int number) {
            if (failed) return;
            // From here on the signals have their usual effect again: an impatient operator ends the process.
            boost::system::error_code ignored;
            impl_->signals.clear(ignored);
            handler(number);
        });
}

void IoLoop::on_hangup(std::function<void()> handler) {
    impl_->hangups.add(SIGHUP);
    impl_->hangups.async_wait(
        [this, handler = std::move(handler)](const boost::system::error_code& failed, int) {
            if (failed) return;
            handler();
            on_hangup(handler);
        });
}

struct LoopTimer::Impl {
    explicit Impl(asio::io_context& context) : timer(context) {}
    asio::steady_timer timer;
};

LoopTimer::LoopTimer(IoLoop& loop) : impl_(std::make_unique<Impl>(loop.impl().context)) {}
LoopTimer::~LoopTimer() = default;

void LoopTimer::start(std::chrono::milliseconds delay, std::function<void()> task) {
    impl_->timer.expires_after(delay);
    impl_->timer.async_wait([task = std::move(task)](const boost::system::error_code& failed) {
        if (!failed) task();
    });
}

void LoopTimer::stop() { impl_->timer.cancel(); }

}  // namespace trochoid
